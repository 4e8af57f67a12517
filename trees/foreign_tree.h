#pragma once
// A tree out of anybody's glTF. Private to trees, but for tree_material, which objects of scenes read, too.
#include "common/gltf/gltf_scene.h"
#include "trees/read_tree.h"

namespace kokage {

Tree read_foreign_tree(const GltfDocument& document, const ReadOptions& options, Progress& progress);

/// The same from meshes and materials that were read already; `path` is named in messages.
Tree tree_from_scene(MeshScene scene, const std::string& path, const ReadOptions& options, Progress& progress);

/// The tree's material for a glTF material; `color_factor` multiplies its base colour (mean vertex colour).
/// Notes what could not be kept.
TreeMaterial tree_material(const SceneMaterial& material, const glm::vec3& color_factor,
                           std::vector<std::string>& notes);

} // namespace kokage

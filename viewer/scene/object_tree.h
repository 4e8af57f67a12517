#pragma once
// An object of a scene as a tree without branches and leaves: parts of bark, opaque.
#include "common/scene/mesh_scene.h"
#include "common/services/progress.h"
#include "viewer/scene/scene_materials.h"

namespace kokage {

/// Reads a glTF, GLB, OBJ or STL. Throws InputError.
MeshScene read_object(const std::filesystem::path& file, Progress& progress);

struct ObjectTree {
    Tree tree;                      ///< in the file's units, +Y up; cut into patches that can carry one radiance
    std::vector<Finish> finishes;   ///< of each of its materials
    glm::dvec3 low{0.0}, high{0.0}; ///< its box, Tree::origin not added
};

/// `z_is_up`: turned from +Z up to +Y up. What has no material or has lost its colour is grey. Throws InputError if
/// there are no triangles.
ObjectTree object_tree(MeshScene scene, const std::filesystem::path& file, bool z_is_up);

} // namespace kokage

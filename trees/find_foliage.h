#pragma once
// Which meshes of a foreign tree are foliage. Private to trees.
#include "common/gltf/gltf_scene.h"
#include "trees/tree.h"

namespace kokage {

struct FoundFoliage {
    std::vector<TreePartKind> kinds; ///< of each mesh of the scene
    std::vector<std::string> notes;  ///< by which rule each material was judged
};

/// In this order: the material's alpha, transmission and name; the names of meshes and their nodes, mesh by mesh where
/// they share a material; green colour; at last shape (many small flat pieces beside wood). A mesh that holds leaves
/// and bark in one material is cut in two by colour or shape (a mesh is added to the scene). `named`: the user's
/// choice, may be empty. Throws InputError (the file's names listed) if a name fits nothing.
FoundFoliage find_foliage(MeshScene& scene, const std::vector<std::string>& named, const std::string& path);

} // namespace kokage

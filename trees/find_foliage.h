#pragma once
// Which meshes of a foreign tree are foliage. Private to trees.
#include "common/gltf/gltf_scene.h"
#include "trees/tree.h"

namespace kokage {

struct FoundFoliage {
    std::vector<TreePartKind> kinds; ///< of each mesh of the scene
    std::vector<std::string> notes;  ///< by which rule each material was judged
};

/// By alpha, transmission, names of materials, then of meshes, then colour; a mesh that holds green leaves and bark in
/// one material is cut in two (a mesh is added to the scene). `named`: the user's choice, may be empty. Throws
/// InputError (the file's names listed) if a name fits nothing.
FoundFoliage find_foliage(MeshScene& scene, const std::vector<std::string>& named, const std::string& path);

/// True if a name speaks of leaves ("leaves", "Needles_02", "DarkGreen"), or of wood ("bark", "Trunk", "woodBirch").
bool names_foliage(const std::string& name);
bool names_wood(const std::string& name);
/// True if it speaks of what stands with a plant and is no part of it ("pot", "soil", "rocks").
bool names_object(const std::string& name);

} // namespace kokage

#pragma once
// Private to trees.
#include "common/scene/mesh_scene.h"
#include "trees/tree.h"

namespace kokage {

/// Gives meshes whose colour texture can't be had, or that have no material, the colour of an average leaf, or of
/// average bark; vertex colours of meshes without material stay as they are. `kinds`: of each mesh of the scene.
/// Returns notes on the missing materials (of lost textures their reader has told).
std::vector<std::string> stand_in_for_lost_colors(MeshScene& scene, const std::vector<TreePartKind>& kinds);

} // namespace kokage

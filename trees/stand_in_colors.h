#pragma once
// Private to trees.
#include "common/scene/mesh_scene.h"
#include "trees/tree.h"

namespace kokage {

/// Gives materials whose colour texture can't be had the colour of an average leaf, or of average bark; `kinds`: of
/// each mesh of the scene.
void stand_in_for_lost_colors(MeshScene& scene, const std::vector<TreePartKind>& kinds);

} // namespace kokage

#pragma once
// The leaves in a foreign tree's foliage. Private to trees.
#include "common/gltf/gltf_scene.h"
#include "common/services/progress.h"

#include <span>
#include <vector>

namespace kokage {

struct FoundLeaves {
    std::vector<std::vector<std::uint32_t>>
        leaf_of; ///< of each mesh, of each of its triangles; numbered over all meshes
    std::uint32_t count = 0;
    float largest_radius_m = 0; ///< larger foliage was cut
    std::size_t stalks = 0;     ///< that were joined to their blades
};

/// A leaf is what is connected, cut where it turns by more than 30 degrees or is larger than `leaf_size` (0: 5 % of the
/// crown's radius, or as large as nine in ten of the flat pieces without alpha are, up to 15 %: so the leaves of a
/// small tree stay whole); a card of one or two triangles is never cut. Slender cards that end at a corner of other
/// foliage are its stalk, and of the same leaf.
FoundLeaves find_leaves(std::span<const SceneMesh> foliage, std::span<const SceneMaterial> materials, float leaf_size,
                        float crown_radius_m, Progress& progress);

} // namespace kokage

#pragma once
// Several trees side by side as one: what light transport and pictures take.
#include "trees/tree.h"

#include <cstdint>
#include <vector>

namespace kokage {

/// Where a tree stands: its foot is moved to its own origin, then it is scaled, turned about +Y (degrees, from +Z
/// towards +X), and moved.
struct TreePlacement {
    glm::dvec3 foot{0.0}; ///< in the tree's coordinates, Tree::origin not added
    glm::dvec3 at{0.0};   ///< metres; where the foot comes to stand
    double turn_degrees = 0, size = 1;
};

/// A direction of the tree in the world, and a point (Tree::origin not added) in coordinates relative to `origin`.
glm::dvec3 placed_direction(const TreePlacement& placement, const glm::dvec3& direction);
glm::dvec3 placed_point(const TreePlacement& placement, const glm::dvec3& point, const glm::dvec3& origin);

/// Which materials of the whole a tree's own became, by its own number; a part's kind chooses.
struct MaterialNumbers {
    std::vector<std::uint32_t> bark, foliage;
};

/// Adds a tree to `all`: its branches, parts, leaves and bark patches after those that are there, relative to
/// all.origin. Notes and materials are the caller's. Throws InputError where the sum has more vertices, leaves or
/// patches than 31 bits number, or a part's material has no number.
void add_tree(Tree& all, const Tree& tree, const TreePlacement& placement, const MaterialNumbers& materials);

} // namespace kokage

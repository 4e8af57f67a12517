#pragma once
// The branching of a foreign tree, inferred from its bark mesh. Private to trees.
#include "trees/axis_samples.h"

#include <span>

namespace kokage {

struct BarkSkeleton {
    Skeleton skeleton;
    std::size_t pieces = 0;   ///< connected pieces of bark
    std::size_t stems = 0;    ///< branches of order 0
    std::size_t lumps = 0;    ///< pieces too stout for wood, such as stones and pots: not in the skeleton
    std::size_t floating = 0; ///< pieces that touch no thicker one and were joined to the nearest
};

/// Each connected piece of bark is thinned to an axis tree: level sets of the distance along the surface from its base,
/// each level's pieces at their centroid (Verroust and Lazarus 1999). Pieces are then joined, thick before thin, each
/// at its point that reaches deepest into thicker wood. At a fork the thicker limb (the longer among about equal ones)
/// goes on; the others are of a higher order. The trunk is the piece with the largest volume that reaches into
/// the lower half.
BarkSkeleton skeleton_from_bark(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

} // namespace kokage

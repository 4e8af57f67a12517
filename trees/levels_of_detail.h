#pragma once
// Simpler trees for the distance: fewer, larger leaves and coarser bark, with the light of the full tree.
#include "trees/tree.h"
#include "trees/write_tree.h"

#include <vector>

namespace kokage {

/// A coarser tree, and which of its patches stands for which of the full tree's.
struct LevelOfDetail {
    Tree tree;
    /// Per patch of the full tree (leaves in order, then bark patches): the patch of `tree` that stands for it; ~0 for
    /// bark that is left out.
    std::vector<std::uint32_t> stands_for;
    /// Per patch of the full tree: 1 if its front is the other's back (leaves whose fronts look away from one another).
    std::vector<std::uint8_t> turned;
    double leaf_area = 0; ///< of one side, holes taken out, m^2
    double bark_area = 0;
};

/// Leaves and bark triangles of a level are this share of the one before: a leaf stands for 3, 9, 27 ... leaves.
inline constexpr int detail_ratio = 3;

/// Level 0 is the full tree, level k has about 3^-k of its leaves and bark triangles, for 0 <= k <= 8.
///
/// Leaves: neighbours are gathered in groups of 3^k (leaf centres halved again and again across their longest extent,
/// within a part). Each group becomes its member nearest to the group's centroid, moved there and scaled about its own
/// centre so that its area is the group's: total leaf area is kept (to rounding), its distribution in space to the
/// groups' size, that of inclinations on average. Texture coordinates stay.
/// Bark: connected pieces are left out until twice the level's triangles are left. The thickest, up to half of the
/// level's triangles, stay as they are. Of the others, trees in leaf keep the thickest, as limbs show between leaves;
/// bare trees keep some at random, as most of what is seen of them is twigs. These are simplified by edge collapses
/// (meshoptimizer) that keep texture seams, and grow in thickness until bark has the full tree's area, where it can be
/// so (keep_bark_area.h). Vertices keep normal and texture coordinate; patches keep their triangles or are taken over
/// by the nearest one of the same part. Throws InputError for another level, or if the tree's indices contradict one
/// another.
LevelOfDetail level_of_detail(const Tree& full, int level);

/// The level's light: each leaf side (and bark patch) has the area-weighted mean radiance of those sides that it stands
/// for, so that leaves send out as much light in all as those of the full tree. Light maps and the scale of COLOR_0
/// stay as they are. Throws InputError if `light` is not the full tree's.
ShadedAttributes transfer_light(const Tree& full, const ShadedAttributes& light, const LevelOfDetail& level);

} // namespace kokage

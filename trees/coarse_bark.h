#pragma once
// Bark with fewer triangles. Private to levels of detail.
#include "trees/tree.h"

#include <utility>
#include <vector>

namespace kokage {

struct CoarseBark {
    TreePart part; ///< its triangle_patch is numbered from 0
    std::uint32_t patches = 0;
    /// For each patch of the fine part: its number there, and the coarse patch that stands for it; ~0 if its piece of
    /// bark is left out.
    std::vector<std::pair<std::uint32_t, std::uint32_t>> stands_for;
};

/// About `share` of the triangles of all parts together, in the same parts, with the area of all: see
/// level_of_detail(). Never fewer than what the thickest piece needs; parts may become empty.
std::vector<CoarseBark> coarse_bark(const std::vector<const TreePart*>& fine, double share, bool bare);

} // namespace kokage

#pragma once
// What leaves see that are too small for line bundles: rays of their own.
//
// Bundles are drawn at so many pixels a leaf of mean size. A tiny leaf beside large cards is met by few lines or none,
// at any number of leaves. Such leaves send rays from points spread over their solid area: what a ray meets becomes a
// neighbour in the leaf's row of Links, in place of what lines found; where a ray gets out is kept here, so that
// another sky needs no new ray. Others still see the leaf by lines, which meet it as often as they should.
#include "foliage/capture_directions.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kokage::bundles {

struct RayLinks {
    std::vector<std::uint32_t> patches; ///< those with rays, ascending; usually none
    std::uint32_t rays_a_row = 0;       ///< of each side, in each half of the rays
    CaptureDirections sky_cells;        ///< how the sky is cut up; empty without patches
    /// Row 4 i + 2 k + h: rays of patches[i], front (k = 0) or back, first or second half, that met no patch: entries
    /// [end_begin[row], end_begin[row + 1]) of `ends`.
    std::vector<std::uint32_t> end_begin;
    /// A cell of the sky; with a ground, for rays that go down: sky_cells.size() + texel of the ground, or
    /// open_ground() beyond the grid.
    std::vector<std::uint16_t> ends;

    bool empty() const { return patches.empty(); }
    std::uint64_t rays() const { return 4 * std::uint64_t(rays_a_row) * patches.size(); }
    std::span<const std::uint16_t> ends_of(std::size_t row) const {
        return {ends.data() + end_begin[row], ends.data() + end_begin[row + 1]};
    }
    std::size_t bytes() const {
        return patches.size() * sizeof(patches[0]) + end_begin.size() * sizeof(end_begin[0]) +
               ends.size() * sizeof(ends[0]) + sky_cells.size() * (sizeof(glm::vec3) + sizeof(float));
    }
};

} // namespace kokage::bundles

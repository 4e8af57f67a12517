#pragma once
// What patches see that are too small or too wide for line bundles: rays of their own.
//
// Bundles are drawn at so many pixels a leaf of mean size. A tiny leaf beside large cards is met by few lines or none,
// at any number of leaves. Such leaves send rays from points spread over their solid area: what a ray meets becomes a
// neighbour in the leaf's row of Links, in place of what lines found; where a ray gets out is kept here, so that
// another sky needs no new ray. Others still see the leaf by lines, which meet it as often as they should.
//
// Surfaces that are very much wider than leaves (Facets::wide_patches) send rays because lines as close as leaves want
// them would mostly be drawn on those.
#include "foliage/capture_directions.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kokage::bundles {

struct RayLinks {
    /// A wide surface sees much at once, and there are few.
    static constexpr std::uint32_t kRaysOfWide = 8; ///< times as many
    std::vector<std::uint32_t> patches;             ///< those with rays, ascending; usually none
    std::size_t small_count = 0;  ///< so many of `patches` are small leaves, which come first; the rest are wide
    std::uint32_t rays_a_row = 0; ///< of each side of a small leaf, in each half of the rays
    CaptureDirections sky_cells;  ///< how the sky is cut up; empty without patches
    /// Row 4 i + 2 k + h: rays of patches[i], front (k = 0) or back, first or second half, that met no patch: entries
    /// [end_begin[row], end_begin[row + 1]) of `ends`.
    std::vector<std::uint32_t> end_begin;
    /// A cell of the sky; with a ground, for rays that go down: sky_cells.size() + texel of the ground, or
    /// open_ground() beyond the grid.
    std::vector<std::uint16_t> ends;

    bool empty() const { return patches.empty(); }
    bool wide(std::size_t i) const { return i >= small_count; } ///< patches[i], whose back is the inside of wood
    /// Of row 4 i + 2 k + h.
    std::uint32_t rays_of(std::size_t row) const {
        return !wide(row / 4) ? rays_a_row : row / 2 % 2 == 0 ? kRaysOfWide * rays_a_row : 0;
    }
    std::uint64_t rays_of_small() const { return 4 * std::uint64_t(rays_a_row) * small_count; }
    std::uint64_t rays_of_wide() const {
        return 2 * std::uint64_t(kRaysOfWide) * rays_a_row * (patches.size() - small_count);
    }
    std::span<const std::uint16_t> ends_of(std::size_t row) const {
        return {ends.data() + end_begin[row], ends.data() + end_begin[row + 1]};
    }
    std::size_t bytes() const {
        return patches.size() * sizeof(patches[0]) + end_begin.size() * sizeof(end_begin[0]) +
               ends.size() * sizeof(ends[0]) + sky_cells.size() * (sizeof(glm::vec3) + sizeof(float));
    }
};

} // namespace kokage::bundles

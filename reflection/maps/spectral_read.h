#pragma once
// Reading grids at texels: the spectral baker's inner loop.
#include "common/directions/ring_transform.h"
#include "reflection/maps/spectral_plan.h"

#include <array>
#include <cstdint>
#include <span>

namespace kokage {

/// Where a texel reads: prepared once.
struct TexelPlace {
    float turn;  ///< azimuth / 2 pi, in [0, 1)
    float polar; ///< polar angle / pi, in [0, 1]
    std::array<float, ShellMix::kMost> weights;
    std::uint32_t texel; ///< index in the layout
    std::uint32_t first; ///< grid that the first weight is for
};

TexelPlace texel_place(const glm::vec3& direction, const ShellMix& mix, std::uint32_t texel);

/// filtered[place.texel] = scale x sum over `grids_a_texel` grids from place.first of weight x the spline there; what
/// is below 0 becomes 0. Returns the least value before that, unscaled. By vectors; the slow twin is
/// RingGrid::lookup().
float read_texels(std::span<const TexelPlace> places, std::span<const RingGrid> grids, std::size_t grids_a_texel,
                  float scale, std::span<glm::vec3> filtered);

} // namespace kokage

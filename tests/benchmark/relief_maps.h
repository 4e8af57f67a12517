#pragma once
// Height maps that relief is measured on. All tile; a map is the same function at every size.
#include "reflection/relief/height_field.h"

#include <cstdint>
#include <string_view>

namespace kokage {

enum class ReliefMap {
    bark,   ///< ridged noise, domain-warped: ridges 9 x 3 and 17 x 6 a tile, and four octaves of noise from 24 x 16 on
    spikes, ///< 48 cones and pyramids on a flat ground, of radius 2.5 to 8.5 % of the tile
    low,    ///< 14 steep posts on a ripple of 3 % of the depth
};
std::string_view relief_map_name(ReliefMap map);

/// How deep the benchmark's maps are on a tile of 1 x 1.
inline constexpr float kBenchReliefDepth = 0.12f;

/// Depths span [0, 1] exactly (a constant one, of a single texel say, is all 0). The same bits on every call.
HeightField make_relief_map(ReliefMap map, int width, int height, std::uint64_t seed = 1);

} // namespace kokage

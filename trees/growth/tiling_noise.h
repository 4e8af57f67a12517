#pragma once
// Patterns that repeat without a seam: noise on lattices that wrap around.
#include "common/services/random.h"
#include "common/types.h"

#include <cmath>

namespace kokage {

/// A whole number modulo `period`, in 0 .. period - 1.
inline int wrapped_cell(int i, int period) {
    const int rest = i % period;
    return rest < 0 ? rest + period : rest;
}

/// A random number in 0..1 of a lattice cell.
inline float cell_value(int i, int j, int period_x, int period_y, std::uint64_t seed) {
    const std::uint64_t ix = std::uint64_t(wrapped_cell(i, period_x)), iy = std::uint64_t(wrapped_cell(j, period_y));
    return float(hash64(seed ^ (ix << 32) ^ iy) >> 40) * 0x1p-24f;
}

/// Value noise, 0..1, smooth; repeats after period_x and period_y cells.
inline float tiling_noise(float x, float y, int period_x, int period_y, std::uint64_t seed) {
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const auto value = [&](int i, int j) { return cell_value(i, j, period_x, period_y, seed); };
    const auto smooth = [](float t) { return t * t * (3 - 2 * t); };
    const float tx = smooth(x - float(x0)), ty = smooth(y - float(y0));
    const float low = value(x0, y0) + tx * (value(x0 + 1, y0) - value(x0, y0));
    const float high = value(x0, y0 + 1) + tx * (value(x0 + 1, y0 + 1) - value(x0, y0 + 1));
    return low + ty * (high - low);
}

/// Cells around one random point each (Worley 1996), in units of the lattice.
struct TilingCell {
    float nearest, second; ///< distances to the nearest point and the next
    float value;           ///< a random number in 0..1 of the nearest point's cell
};
inline TilingCell tiling_cells(float x, float y, int period_x, int period_y, std::uint64_t seed) {
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    TilingCell cell{1e9f, 1e9f, 0};
    for (int j = y0 - 1; j <= y0 + 1; ++j)
        for (int i = x0 - 1; i <= x0 + 1; ++i) {
            const float dx = float(i) + 0.1f + 0.8f * cell_value(i, j, period_x, period_y, seed) - x,
                        dy = float(j) + 0.1f + 0.8f * cell_value(i, j, period_x, period_y, seed + 0x9e37) - y;
            const float distance = std::sqrt(dx * dx + dy * dy);
            if (distance < cell.nearest) {
                cell.second = cell.nearest;
                cell.nearest = distance;
                cell.value = cell_value(i, j, period_x, period_y, seed + 0x79b9);
            } else if (distance < cell.second) {
                cell.second = distance;
            }
        }
    return cell;
}

} // namespace kokage

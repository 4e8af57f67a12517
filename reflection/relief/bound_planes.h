#pragma once
// A hierarchy of tilted planes that never lie below the relief's surface. Private to relief.
//
//      depth 0 -------------------------------
//                    ___...---"""    the plane of a node: all of the surface under it is at least as deep, and
//          plane  /\      /\__/"\    at most `thickness` deeper
//                /  \_/\_/       \   .
//
// Level 0 are the cells themselves; a node of level l covers 2^l x 2^l cells, less at the right and lower border.
#include "reflection/relief/height_field.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace kokage {

/// A node's bound at (u, v) texels from its middle (2^(l-1) cells from its first corner on both axes, clipped or not):
/// surface depth >= middle 2^-16 + (slope_u u + slope_v v) 2^-(14 + l), and exceeds that by <= thickness 2^-14.
struct BoundPlane {
    std::int16_t slope_u = 0, slope_v = 0;
    std::uint16_t middle = 0, thickness = 0;
};
static_assert(sizeof(BoundPlane) == 8);

struct BoundLevel {
    int columns = 0, rows = 0;
    std::size_t first = 0; ///< of its nodes among all
};

/// Depths of a field and the planes over them.
struct BoundPlanes {
    static constexpr int kMostSide = 1 << 15; ///< cells: 16 levels

    int width = 0, height = 0; ///< of the field
    HeightWrap wrap = HeightWrap::repeat;
    int columns = 0, rows = 0;      ///< of cells: as texels, or one more where clamped (half of the border's outside)
    std::vector<float> depths;      ///< corners of cells: (columns + 1) x (rows + 1)
    std::vector<BoundLevel> levels; ///< [0] stands for the cells; the last one has a single node
    std::vector<BoundPlane> planes; ///< level by level, row by row

    int stride() const { return columns + 1; }
    /// The first column or row of `depths` is this texel.
    int first_texel() const { return wrap == HeightWrap::clamp ? -1 : 0; }
    std::size_t bytes() const { return depths.size() * sizeof(float) + planes.size() * sizeof(BoundPlane); }
};

/// Throws InputError for fields that are empty, too large, or hold depths outside [0, 1].
BoundPlanes make_bound_planes(const HeightField& field);

void store_bound_planes(const BoundPlanes& bounds, const std::filesystem::path& path);
/// Throws InputError where the file is not one of planes for this very field, or was cut off or altered.
BoundPlanes load_bound_planes(const HeightField& field, const std::filesystem::path& path);

} // namespace kokage

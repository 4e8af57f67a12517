#pragma once
// Who sees whom, as compressed rows: the form in which light is sent along lines.
#include "common/services/uninitialized_vector.h"

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

namespace kokage::bundles {

/// A square of ground texels around the tree, lit and shaded by it; beyond it the ground is taken to lie open.
struct GroundGrid {
    static constexpr int kSize = 32;
    static constexpr std::uint32_t kTexels = kSize * kSize;
    static constexpr int kStride = 2; ///< every 2nd pixel in u and v is followed to the ground
    float height = 0;                 ///< scaled y
    glm::vec2 low{0.f};               ///< scaled x, z of the corner
    float texel = 1;                  ///< scaled side of a texel
    int texel_at(float x, float z) const {
        const float i = (x - low.x) / texel, j = (z - low.y) / texel;
        return i >= 0 && j >= 0 && i < kSize && j < kSize ? int(j) * kSize + int(i) : -1;
    }
};

/// Sides are numbered 2 x patch (front) and 2 x patch + 1 (back).
using Side = std::uint32_t;

/// The neighbours of every side on all lines, one entry a line, in compressed rows; and its ends on the ground.
/// Row of side s: entries [begin[s], begin[s+1]), of the first half of the directions before middle[s], of the second
/// after.
struct Links {
    std::vector<std::uint32_t> begin, middle;
    UninitializedVector<Side> neighbours;
    /// Lines that end on a texel of the ground, one in kStride^2, direction by direction.
    struct GroundLink {
        Side side;
        std::uint32_t texel;
    };
    std::vector<GroundLink> ground;
    std::vector<std::uint32_t> ground_begin; ///< of each direction, + 1
    std::vector<float>
        ground_pixel_area; ///< of each direction: scaled area that one ground link stands for, across the line
};

} // namespace kokage::bundles

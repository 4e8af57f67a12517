#pragma once
// Who sees whom, as compressed rows: the form in which light is sent along lines.
#include "common/services/uninitialized_vector.h"

#include <cstdint>
#include <glm/vec2.hpp>
#include <span>
#include <vector>

namespace kokage::bundles {

/// A square of ground texels around the tree, lit and shaded by it; beyond it the ground is taken to lie open.
struct GroundGrid {
    static constexpr int kStride = 2; ///< every 2nd pixel in u and v is followed to the ground
    int size = 32;                    ///< texels along a side
    float height = 0;                 ///< scaled y
    glm::vec2 low{0.f};               ///< scaled x, z of the corner
    float texel = 1;                  ///< scaled side of a texel
    std::uint32_t texels() const { return std::uint32_t(size) * std::uint32_t(size); }
    /// -1 outside.
    int texel_at(float x, float z) const {
        const float i = (x - low.x) / texel, j = (z - low.y) / texel;
        return i >= 0 && j >= 0 && i < float(size) && j < float(size) ? int(j) * size + int(i) : -1;
    }
    glm::vec2 centre_of(std::uint32_t index) const {
        const auto side = std::uint32_t(size);
        return low + texel * (glm::vec2(float(index % side), float(index / side)) + 0.5f);
    }
};

/// Sides are numbered 2 x patch (front) and 2 x patch + 1 (back).
using Side = std::uint32_t;

/// The neighbours of every side on all lines, one entry a line, in compressed rows; and its ends on the ground.
///
/// Rows don't lie in the order of the sides, but within blocks of kBlock sides in order of length: at the end of a row
/// of unforeseen length a processor loses as much time as for ten links. The row at place k of them all is entries
/// [begin[k], begin[k+1]), of the first half of the directions before middle[k], of the second after.
struct Links {
    static constexpr std::size_t kBlock = 4096;
    std::vector<std::uint16_t>
        side_at; ///< of each place: the side whose row lies there, counted from its block's first
    std::vector<std::uint16_t> place_of;      ///< of each side: the place of its row, counted from its block's first
    std::vector<std::uint32_t> begin, middle; ///< of each place; begin: + 1
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

    std::size_t side_count() const { return place_of.size(); }
    std::size_t place(Side side) const { return side / kBlock * kBlock + place_of[side]; }
    std::uint32_t row_length(Side side) const { return begin[place(side) + 1] - begin[place(side)]; }
    std::span<const Side> row(Side side) const { return part(begin[place(side)], begin[place(side) + 1]); }
    std::span<const Side> half_row(Side side, int half) const {
        const std::size_t k = place(side);
        return half == 0 ? part(begin[k], middle[k]) : part(middle[k], begin[k + 1]);
    }
    /// Makes room for rows of so many neighbours of the first and the second half of the directions, per side.
    void lay_out(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second);

  private:
    std::span<const Side> part(std::uint32_t from, std::uint32_t to) const {
        return {neighbours.data() + from, neighbours.data() + to};
    }
};

} // namespace kokage::bundles

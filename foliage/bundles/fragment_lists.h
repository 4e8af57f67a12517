#pragma once
// The fragments of a picture, pixel by pixel in order of depth.
//
// Lists of kGroup pixels side by side are laid side by side, so that a vector works on as many pixels as it has lanes:
//
//   pixel     0   1   2 ... 15 | 16  17 ... 31 |        a row holds the i-th keys of the pixels of a group;
//   row 0    a0  b0  c0        | q0  r0        |        a group has as many rows as its longest list
//   row 1    a1      c1        |     r1        |
#include "common/services/uninitialized_vector.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kokage::bundles {

struct FragmentLists {
    static constexpr std::size_t kGroup = 16;
    std::vector<std::uint32_t> group_row;    ///< number of each group's first row, + 1
    std::vector<std::uint32_t> list_end;     ///< per pixel: the place in `keys` one row behind its last key
    UninitializedVector<std::uint32_t> keys; ///< [row][pixel in group]; places behind a list's end hold anything

    std::size_t group_count() const { return list_end.size() / kGroup; }
    std::uint32_t count(std::size_t pixel) const {
        return list_end[pixel] / std::uint32_t(kGroup) - group_row[pixel / kGroup];
    }
    std::uint32_t key(std::size_t pixel, std::uint32_t i) const {
        return keys[(std::size_t(group_row[pixel / kGroup]) + i) * kGroup + pixel % kGroup];
    }
};

/// Puts fragments in order: pixel by pixel, then by key. `pixels`, a multiple of kGroup: of the picture. Adds to
/// near_count and far_count, by face (low bits of the key, `face_mask`), at how many pixels a face is the first / last.
void sort_fragments(std::size_t pixels, std::span<const std::uint32_t> fragment_pixel,
                    std::span<const std::uint32_t> fragment_key, std::uint32_t face_mask, FragmentLists& lists,
                    std::vector<std::uint32_t>& near_count, std::vector<std::uint32_t>& far_count);

} // namespace kokage::bundles

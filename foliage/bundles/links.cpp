#include "foliage/bundles/links.h"

#include "common/services/parallel.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace kokage::bundles {

void Links::lay_out(std::span<const std::uint32_t> first, std::span<const std::uint32_t> second) {
    constexpr std::size_t kLengths = 64, kHalfLengths = 32; // all longer ones are taken to be alike
    const std::size_t sides = first.size();
    side_at.resize(sides);
    place_of.resize(sides);
    parallel_blocks(sides, kBlock, [&](std::size_t from, std::size_t to) {
        // Counting sort by the length of the row, then of its first half.
        std::array<std::uint16_t, kLengths * kHalfLengths + 1> next{};
        const auto lengths = [&](std::size_t side) {
            const std::size_t row = std::size_t(first[side]) + second[side];
            return std::min(row, kLengths - 1) * kHalfLengths + std::min<std::size_t>(first[side], kHalfLengths - 1);
        };
        for (std::size_t side = from; side < to; ++side)
            ++next[lengths(side) + 1];
        std::partial_sum(next.begin(), next.end(), next.begin());
        for (std::size_t side = from; side < to; ++side) {
            place_of[side] = next[lengths(side)]++;
            side_at[from + place_of[side]] = std::uint16_t(side - from);
        }
    });
    begin.resize(sides + 1);
    middle.resize(sides);
    std::uint32_t running = 0;
    for (std::size_t k = 0; k < sides; ++k) {
        const std::size_t side = k / kBlock * kBlock + side_at[k];
        begin[k] = running;
        middle[k] = running + first[side];
        running = middle[k] + second[side];
    }
    begin[sides] = running;
    neighbours.resize(running);
}

} // namespace kokage::bundles

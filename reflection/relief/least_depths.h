#pragma once
// The least depth of any rectangle of texels. Private to relief.
#include "reflection/relief/bilinear_cell.h"

#include <algorithm>
#include <bit>
#include <vector>

namespace kokage {

/// Level k holds, for every texel, the least depth of the 2^k x 2^k texels from there on to the right and down.
class LeastDepths {
  public:
    explicit LeastDepths(const HeightField& field) : field_(field) {
        levels_.push_back(field.depths);
        const int largest = std::max(field.width, field.height);
        for (int reach = 1; 2 * reach <= largest; reach *= 2) {
            const std::vector<float>& finer = levels_.back();
            std::vector<float> level(finer.size());
            for (int y = 0; y < field.height; ++y)
                for (int x = 0; x < field.width; ++x) {
                    const int x1 = texel_index(x + reach, field.width, field.wrap),
                              y1 = texel_index(y + reach, field.height, field.wrap);
                    level[place(x, y)] =
                        std::min({finer[place(x, y)], finer[place(x1, y)], finer[place(x, y1)], finer[place(x1, y1)]});
                }
            levels_.push_back(std::move(level));
        }
    }

    /// Of the texels x0..x1, y0..y1, both ends included, which may lie beyond the tile.
    float least(long long x0, long long x1, long long y0, long long y1) const {
        const Range across = range(x0, x1, field_.width), down = range(y0, y1, field_.height);
        const unsigned shorter = unsigned(std::min(across.count, down.count));
        const int level = std::min(int(std::bit_width(shorter)) - 1, int(levels_.size()) - 1), reach = 1 << level;
        float least = 1;
        for (int y = 0; y < down.count; y += reach)
            for (int x = 0; x < across.count; x += reach)
                least = std::min(least, levels_[std::size_t(level)][place(at(across, x, reach, field_.width),
                                                                          at(down, y, reach, field_.height))]);
        return least;
    }

  private:
    struct Range {
        int first, count; ///< first within the tile
    };
    Range range(long long a, long long b, int size) const {
        if (field_.wrap == HeightWrap::clamp) {
            const int first = texel_index(a, size, field_.wrap);
            return {first, texel_index(b, size, field_.wrap) - first + 1};
        }
        if (b - a + 1 >= size)
            return {0, size};
        return {texel_index(a, size, field_.wrap), int(b - a + 1)};
    }
    /// The last window is moved back so that it ends with the range.
    static int at(const Range& range, int offset, int reach, int size) {
        const int i = range.first + std::min(offset, range.count - reach);
        return i >= size ? i - size : i;
    }
    std::size_t place(int x, int y) const { return std::size_t(y) * std::size_t(field_.width) + std::size_t(x); }

    const HeightField& field_;
    std::vector<std::vector<float>> levels_;
};

} // namespace kokage

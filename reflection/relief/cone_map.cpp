#include "reflection/relief/cone_map.h"
#include "common/services/checked_file.h"
#include "common/services/parallel.h"
#include "reflection/relief/bilinear_cell.h"

#include <algorithm>
#include <array>

namespace kokage {
namespace {

/// Least depths of blocks of texels, 2^level on a side; level 0 is the texels.
struct DepthPyramid {
    struct Level {
        int columns = 0, rows = 0;
        std::vector<float> least;
    };
    std::vector<Level> levels;

    explicit DepthPyramid(const HeightField& field) {
        levels.push_back({field.width, field.height, field.depths});
        while (levels.back().columns > 1 || levels.back().rows > 1) {
            const Level& from = levels.back();
            Level to{(from.columns + 1) / 2, (from.rows + 1) / 2, {}};
            for (int y = 0; y < to.rows; ++y)
                for (int x = 0; x < to.columns; ++x) {
                    const int x1 = std::min(2 * x + 1, from.columns - 1), y1 = std::min(2 * y + 1, from.rows - 1);
                    const auto at = [&](int i, int j) {
                        return from.least[std::size_t(j) * std::size_t(from.columns) + std::size_t(i)];
                    };
                    to.least.push_back(std::min({at(2 * x, 2 * y), at(x1, 2 * y), at(2 * x, y1), at(x1, y1)}));
                }
            levels.push_back(std::move(to));
        }
    }
};

/// Texels from `cell` (its corners stand at cell and cell + 1) to the nearest of texels first ... last.
int distance(int cell, int first, int last, int count, HeightWrap wrap) {
    if (wrap == HeightWrap::clamp)
        return std::max({0, first - cell - 1, cell - last});
    const auto ahead = [&](int way) { return way < 0 ? way + count : way >= count ? way - count : way; };
    const int onwards = ahead(first - cell), back = ahead(cell - last); // from the first corner, 0 ... count - 1
    if (onwards + (last - first) >= count || onwards <= 1)
        return 0;
    return std::min(onwards - 1, back);
}

class ConeSearch {
  public:
    ConeSearch(const HeightField& field, const DepthPyramid& pyramid) : field_(field), pyramid_(pyramid) {}

    CellCone cone(int i, int j) {
        i_ = i;
        j_ = j;
        const int x1 = texel_index(i + 1, field_.width, field_.wrap),
                  y1 = texel_index(j + 1, field_.height, field_.wrap);
        top_ = std::min({field_.depth(i, j), field_.depth(x1, j), field_.depth(i, y1), field_.depth(x1, y1)});
        ratio_ = double(kEmptyRatio);
        // What bounded the cell before most likely bounds this one closely.
        const Block guess = bounding_;
        consider(guess);
        std::size_t count = 1;
        stack_[0] = block(int(pyramid_.levels.size()) - 1, 0, 0);
        while (count > 0) {
            const Block& next = stack_[--count];
            if (!(next.least_ratio < ratio_))
                continue;
            if (next.level == 0) {
                consider(next);
                continue;
            }
            count = push_children(next, count);
        }
        return {top_, float(ratio_ * (1 - 1e-6))}; // rounded to the safe side
    }

  private:
    struct Block {
        int level = 0, x = 0, y = 0;
        double least_ratio = 0; ///< no texel of it bounds the cone to less
    };

    Block block(int level, int x, int y) const {
        const DepthPyramid::Level& l = pyramid_.levels[std::size_t(level)];
        const double gap = double(top_) - double(l.least[std::size_t(y) * std::size_t(l.columns) + std::size_t(x)]);
        if (gap <= 0)
            return {level, x, y, double(kEmptyRatio)};
        const int side = 1 << level, x0 = x * side, y0 = y * side;
        const int away = distance(i_, x0, std::min(x0 + side, field_.width) - 1, field_.width, field_.wrap) +
                         distance(j_, y0, std::min(y0 + side, field_.height) - 1, field_.height, field_.wrap);
        return {level, x, y, away / gap};
    }

    void consider(const Block& texel) {
        const double ratio = block(0, texel.x, texel.y).least_ratio;
        if (ratio < ratio_) {
            ratio_ = ratio;
            bounding_ = texel;
        }
    }

    /// The nearest comes to lie on top of the stack.
    std::size_t push_children(const Block& parent, std::size_t count) {
        const DepthPyramid::Level& below = pyramid_.levels[std::size_t(parent.level - 1)];
        std::array<Block, 4> children;
        std::size_t found = 0;
        const int level = parent.level - 1, x = 2 * parent.x, y = 2 * parent.y;
        for (int dy = 0; dy < 2 && y + dy < below.rows; ++dy)
            for (int dx = 0; dx < 2 && x + dx < below.columns; ++dx) {
                const Block child = block(level, x + dx, y + dy);
                if (!(child.least_ratio < ratio_))
                    continue;
                std::size_t at = found++;
                for (; at > 0 && children[at - 1].least_ratio < child.least_ratio; --at)
                    children[at] = children[at - 1];
                children[at] = child;
            }
        return std::size_t(std::copy_n(children.begin(), found, stack_.begin() + std::ptrdiff_t(count)) -
                           stack_.begin());
    }

    const HeightField& field_;
    const DepthPyramid& pyramid_;
    int i_ = 0, j_ = 0;
    float top_ = 0;
    double ratio_ = 0;
    Block bounding_;
    std::array<Block, 128> stack_; ///< at most three wait on each of up to 32 levels
};

constexpr CheckedFileKind kStoredCones{
    {'K', 'o', 'C', 'o', 'n', 'e', 's', 'R'}, 1, "relief cones", "another height field"};

std::uint64_t identity_of(const HeightField& field) {
    FileIdentity identity;
    identity.add_value(field.width);
    identity.add_value(field.height);
    identity.add_value(int(field.wrap));
    identity.add(std::as_bytes(std::span(field.depths)));
    return identity.value();
}

} // namespace

std::vector<CellCone> make_cone_map(const HeightField& field) {
    const DepthPyramid pyramid(field);
    std::vector<CellCone> cones(field.depths.size());
    parallel_blocks(std::size_t(field.height), 8, [&](std::size_t begin, std::size_t end) {
        ConeSearch search(field, pyramid);
        for (std::size_t j = begin; j < end; ++j)
            for (std::size_t i = 0; i < std::size_t(field.width); ++i)
                cones[j * std::size_t(field.width) + i] = search.cone(int(i), int(j));
    });
    return cones;
}

void store_cone_map(const HeightField& field, const std::vector<CellCone>& cones, const std::filesystem::path& path) {
    const std::array arrays{std::as_bytes(std::span(cones))};
    write_checked_file(path, kStoredCones, identity_of(field), arrays);
}

std::vector<CellCone> load_cone_map(const HeightField& field, const std::filesystem::path& path) {
    const CheckedFile file(path, kStoredCones, identity_of(field));
    std::vector<CellCone> cones = file.copied<CellCone>(0);
    if (cones.size() != field.depths.size())
        file.refuse_altered("it has " + std::to_string(cones.size()) + " cones, not " +
                            std::to_string(field.depths.size()));
    for (const CellCone& cone : cones)
        if (!(cone.top >= 0 && cone.top <= 1 && cone.ratio > 0 && cone.ratio <= kEmptyRatio))
            file.refuse_altered("it has a cone of ratio " + std::to_string(cone.ratio) + " at depth " +
                                std::to_string(cone.top));
    return cones;
}

} // namespace kokage

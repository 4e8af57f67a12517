// Every plane of a hierarchy against every corner of the cells under it.
#include "reflection/relief/bound_planes.h"
#include "tests/support/instruction_sets.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace kokage {
namespace {

enum class Kind { noise, waves, steps, constant, holes };

HeightField field_of(Kind kind, int width, int height, HeightWrap wrap, std::uint32_t seed) {
    HeightField field{width, height, wrap, std::vector<float>(std::size_t(width) * std::size_t(height))};
    std::mt19937 engine(seed);
    const float level = float(engine() % 5) / 4;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const float random = float(engine() >> 8) * 0x1p-24f, u = float(x) / float(width),
                        v = float(y) / float(height);
            float depth = level;
            if (kind == Kind::noise)
                depth = random;
            else if (kind == Kind::waves)
                depth = 0.5f + 0.5f * std::sin(12 * u) * std::cos(9 * v);
            else if (kind == Kind::steps)
                depth = float(int(3 * u + 2 * v) % 3) / 2;
            else if (kind == Kind::holes && random < 0.02f)
                depth = 1 - level;
            field.depths[std::size_t(y) * std::size_t(width) + std::size_t(x)] = std::clamp(depth, 0.f, 1.f);
        }
    return field;
}

/// Least and greatest of: depth over the plane.
std::pair<double, double> range_over(const BoundPlanes& bounds, std::size_t level, int column, int row) {
    const int side = 1 << level, x0 = column * side, y0 = row * side;
    const BoundPlane& plane =
        bounds.planes[bounds.levels[level].first + std::size_t(row) * std::size_t(bounds.levels[level].columns) +
                      std::size_t(column)];
    const double unit = std::ldexp(1., -14 - int(level));
    double least = 1e9, greatest = -1e9;
    for (int y = y0; y <= std::min(y0 + side, bounds.rows); ++y)
        for (int x = x0; x <= std::min(x0 + side, bounds.columns); ++x) {
            const double depth = bounds.depths[std::size_t(y) * std::size_t(bounds.stride()) + std::size_t(x)];
            const double over = depth - (plane.middle / 65536. + unit * (plane.slope_u * (x - x0 - 0.5 * side) +
                                                                         plane.slope_v * (y - y0 - 0.5 * side)));
            least = std::min(least, over);
            greatest = std::max(greatest, over);
        }
    EXPECT_LE(greatest, plane.thickness / 16384.);
    return {least, greatest};
}

void expect_bounds(const BoundPlanes& bounds) {
    ASSERT_EQ(bounds.levels.back().columns * bounds.levels.back().rows, 1);
    for (std::size_t level = 1; level < bounds.levels.size(); ++level)
        for (int row = 0; row < bounds.levels[level].rows; ++row)
            for (int column = 0; column < bounds.levels[level].columns; ++column) {
                const auto [least, greatest] = range_over(bounds, level, column, row);
                ASSERT_GE(least, 0) << "level " << level << " (" << column << ", " << row << ')';
                ASSERT_LE(least, 3 * 0x1p-16)
                    << "level " << level << " (" << column << ", " << row << "): touches no surface";
            }
}

TEST(BoundPlanes, NeverLieBelowTheSurfaceNorFarAboveIt) {
    constexpr int kSizes[][2] = {{1, 1}, {1, 7}, {9, 2}, {37, 53}, {64, 64}, {128, 40}, {200, 100}};
    test::with_every_instruction_set([&] {
        for (const auto& [width, height] : kSizes)
            for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp})
                for (const Kind kind : {Kind::noise, Kind::waves, Kind::steps, Kind::constant, Kind::holes}) {
                    SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height) + ", kind " +
                                 std::to_string(int(kind)));
                    const BoundPlanes bounds = make_bound_planes(field_of(kind, width, height, wrap, 5));
                    ASSERT_EQ(bounds.columns, width + (wrap == HeightWrap::clamp));
                    expect_bounds(bounds);
                }
    });
}

TEST(BoundPlanes, LieOnAPlaneWhereTheSurfaceIsOne) {
    HeightField field{65, 65, HeightWrap::clamp, std::vector<float>(65 * 65)};
    for (int y = 0; y < 65; ++y)
        for (int x = 0; x < 65; ++x)
            field.depths[std::size_t(y * 65 + x)] = 0.2f + 0.008f * float(x) + 0.003f * float(y);
    const BoundPlanes bounds = make_bound_planes(field);
    for (std::size_t level = 1; level <= 5; ++level) { // inside, away from the border that goes on level
        const auto [least, greatest] = range_over(bounds, level, 1, 1);
        EXPECT_LT(greatest, 2e-3) << level;
    }
}

TEST(BoundPlanes, AreTighterThanLevelOnes) {
    const BoundPlanes bounds = make_bound_planes(field_of(Kind::waves, 128, 128, HeightWrap::repeat, 1));
    for (std::size_t level = 1; level <= 4; ++level) {
        const BoundLevel& nodes = bounds.levels[level];
        double tilted = 0, flat = 0;
        for (int row = 0; row < nodes.rows; ++row)
            for (int column = 0; column < nodes.columns; ++column) {
                const int side = 1 << level;
                double least = 1;
                for (int y = 0; y <= side; ++y)
                    for (int x = 0; x <= side; ++x)
                        least = std::min(
                            least, double(bounds.depths[std::size_t(row * side + y) * std::size_t(bounds.stride()) +
                                                        std::size_t(column * side + x)]));
                flat += least;
                tilted += bounds.planes[nodes.first + std::size_t(row * nodes.columns + column)].middle / 65536.;
            }
        EXPECT_GT(tilted, flat) << level;
    }
}

} // namespace
} // namespace kokage

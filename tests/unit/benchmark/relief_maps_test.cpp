// The benchmark's height maps.
#include "tests/benchmark/relief_maps.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

constexpr ReliefMap kMaps[] = {ReliefMap::bark, ReliefMap::spikes, ReliefMap::low};

TEST(ReliefMaps, SpanZeroToOneAndAreTheSameAtEachCall) {
    for (const ReliefMap map : kMaps) {
        const HeightField field = make_relief_map(map, 61, 40);
        ASSERT_EQ(field.depths.size(), 61u * 40u);
        const auto [least, most] = std::minmax_element(field.depths.begin(), field.depths.end());
        EXPECT_EQ(*least, 0.f) << relief_map_name(map);
        EXPECT_EQ(*most, 1.f) << relief_map_name(map);
        EXPECT_EQ(field.depths, make_relief_map(map, 61, 40).depths) << relief_map_name(map);
        EXPECT_NE(field.depths, make_relief_map(map, 61, 40, 2).depths) << relief_map_name(map);
        EXPECT_EQ(make_relief_map(map, 1, 1).depths, std::vector<float>{0.f});
    }
}

// A map that tiles steps over the tile's edge as it steps within.
TEST(ReliefMaps, Tile) {
    for (const ReliefMap map : kMaps) {
        const HeightField field = make_relief_map(map, 256, 256);
        std::vector<double> steps(256, 0.); // from column x to the next, root of the mean square
        for (int x = 0; x < 256; ++x) {
            for (int y = 0; y < 256; ++y)
                steps[std::size_t(x)] += std::pow(double(field.depth((x + 1) % 256, y)) - double(field.depth(x, y)), 2);
            steps[std::size_t(x)] = std::sqrt(steps[std::size_t(x)] / 256);
        }
        EXPECT_LE(steps[255], *std::max_element(steps.begin(), steps.end() - 1)) << relief_map_name(map);
    }
}

// What the maps are for: bark fills its depth, spikes stand on a flat ground, the low map is nearly all ground.
TEST(ReliefMaps, AreAsDeepAsTheyShould) {
    const auto share_below = [](ReliefMap map, float depth) {
        const HeightField field = make_relief_map(map, 256, 256);
        return double(std::count_if(field.depths.begin(), field.depths.end(), [&](float d) { return d >= depth; })) /
               double(field.depths.size());
    };
    EXPECT_NEAR(share_below(ReliefMap::bark, 0.4f), 0.5, 0.2);
    EXPECT_NEAR(share_below(ReliefMap::spikes, 1.f), 0.68, 0.15);
    EXPECT_GT(share_below(ReliefMap::low, 0.97f), 0.9);
    EXPECT_LT(share_below(ReliefMap::low, 0.97f), 0.99);
}

} // namespace

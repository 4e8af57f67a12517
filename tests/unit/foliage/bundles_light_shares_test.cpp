// Which part of the light came to come from elsewhere.
#include "foliage/bundles/light_shares.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace bundles;

TEST(BundlesLightShares, AddUpAndDoNotDependOnBrightnessOrResolution) {
    Environment environment = test::sky_and_sun();
    environment.point_lights = {{"lamp", {0, 3, 0}, {4, 8, 2}}};
    const auto shares = light_shares(environment, {0, 1, 0}, false);
    ASSERT_EQ(shares.size(), 2u + 32u);
    glm::vec3 sum(0.f);
    for (const glm::vec3& share : shares)
        sum += share;
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c], 1, 1e-5);
    EXPECT_NEAR(shares[1].g / shares[0].g, 8.0 / 4 / 9, 1e-5) << "at 2 m";
    Environment brighter = environment;
    brighter.distant_lights[0].irradiance *= 7;
    brighter.point_lights[0].intensity *= 7;
    for (float& value : brighter.remainder.pixels)
        value *= 7;
    EXPECT_LT(moved_light(shares, light_shares(brighter, {0, 1, 0}, false)), 1e-5);

    Environment coarse = constant_environment({1, 2, 3}), fine = coarse;
    fine.remainder = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 3; ++c)
                fine.remainder.at(x, y)[c] = float(1 + c);
    EXPECT_LT(moved_light(light_shares(coarse, {}, false), light_shares(fine, {}, false)), 1e-5);
}

TEST(BundlesLightShares, WhatMovedIsCountedOnce) {
    Environment before = constant_environment(glm::vec3(1)), now = before;
    now.remainder = Image(128, 64, 3);
    std::fill(now.remainder.pixels.begin(), now.remainder.pixels.begin() + 3 * 128 * 32, 1.f); // the upper half
    EXPECT_NEAR(moved_light(light_shares(before, {}, false), light_shares(now, {}, false)), 0.5, 0.01);
    EXPECT_LT(moved_light(light_shares(before, {}, true), light_shares(now, {}, true)), 0.01)
        << "what the ground hides does not count";
    Environment red = before;
    red.distant_lights.resize(1);
    red.distant_lights[0].irradiance = {4 * kPi, 0, 0};
    before.distant_lights.resize(1);
    EXPECT_NEAR(moved_light(light_shares(before, {}, false), light_shares(red, {}, false)), 0.5, 1e-4);
    EXPECT_EQ(moved_light(light_shares(before, {}, true), light_shares(before, {}, false)), 1);
    Environment dark = constant_environment(glm::vec3(0));
    EXPECT_EQ(moved_light(light_shares(dark, {}, false), light_shares(dark, {}, false)), 0);
}

} // namespace
} // namespace kokage

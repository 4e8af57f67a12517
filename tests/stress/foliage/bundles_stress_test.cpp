// Extremes that must stay finite, and where physics says so, stay the same.
#include "foliage/method.h"
#include "tests/unit/foliage/shade_small_trees.h"
#include "tests/unit/foliage/solution_checks.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

Solution shade(const test::SmallTree& small, const Environment& environment, int directions = 20) {
    ShadingOptions options;
    options.method = Method::bundles;
    options.effort = directions;
    options.for_hosts = true;
    return test::shade(small, environment, options);
}

void expect_finite(const Solution& solution) {
    test::expect_finite(solution);
    ASSERT_TRUE(solution.estimated_error);
}

TEST(BundlesStress, NothingToShade) {
    const Solution nothing = shade({}, test::sky_and_sun());
    expect_finite(nothing);
    EXPECT_TRUE(nothing.radiance.front.empty());
    EXPECT_EQ(nothing.energy_in, 0);
    test::SmallTree bare;
    bare.scene.ground = Ground{};
    expect_finite(shade(bare, test::sky_and_sun()));
}

TEST(BundlesStress, OneLeaf) {
    for (const glm::vec3& v : {glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)}) { // lying and upright
        test::SmallTree lone;
        lone.scene.optics = {test::grey_leaf(0.5f)};
        test::add_rectangle(lone.scene, {0, 1, 0}, {1, 0, 0}, v);
        const Solution solution = shade(lone, constant_environment(glm::vec3(2)));
        expect_finite(solution);
        EXPECT_NEAR(solution.radiance.front[0].r, 1, 1e-3);
        EXPECT_NEAR(solution.radiance.back[0].r, 1, 1e-3);
        lone.scene.ground = Ground{};
        expect_finite(shade(lone, test::sky_and_sun()));
    }
}

TEST(BundlesStress, ALeafWithoutAreaAlone) {
    test::SmallTree lone;
    lone.scene.optics = {test::grey_leaf(0.5f)};
    test::add_rectangle(lone.scene, {0, 1, 0}, {1, 0, 0}, {0, 0, 0});
    expect_finite(shade(lone, test::sky_and_sun()));
    test::add_rectangle(lone.scene, {0, 1, 0}, {0, 0, 0}, {0, 0, 0});
    expect_finite(shade(lone, test::sky_and_sun()));
}

TEST(BundlesStress, CoincidentAndEmptyLeavesAndBlackSkies) {
    test::SmallTree tree = test::ball_on_a_skeleton(50, 2, test::grey_leaf(1));
    test::add_coincident_and_empty_leaves(tree);
    expect_finite(shade(tree, test::sky_and_sun()));
    const Solution black = shade(tree, constant_environment(glm::vec3(0)));
    expect_finite(black);
    EXPECT_EQ(test::mean(black), 0);
    EXPECT_EQ(black.energy_in, 0);
}

TEST(BundlesStress, TreesOfAnySizeAreLitAlike) {
    test::SmallTree tree = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    tree.scene.ground = Ground{0.5f};
    const double expected = test::mean(shade(tree, test::sky_and_sun()));
    for (float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
        const Solution solution = shade(test::transformed(tree, scale, glm::vec3(0)), test::sky_and_sun());
        expect_finite(solution);
        EXPECT_NEAR(test::mean(solution), expected, 0.01 * expected) << scale;
    }
}

TEST(BundlesStress, FarFromTheOriginNothingBreaks) {
    const test::SmallTree tree = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    expect_finite(
        shade(test::transformed(tree, 1, {1e7f, 0, -1e7f}), test::sky_and_sun())); // positions are rounded to metres
    // Where positions can still be told apart, light is the same.
    const double expected = test::mean(shade(tree, test::sky_and_sun()));
    const Solution big = shade(test::transformed(tree, 1e5f, {1e7f, 0, -1e7f}), test::sky_and_sun());
    expect_finite(big);
    EXPECT_NEAR(test::mean(big), expected, 0.01 * expected);
}

TEST(BundlesStress, LightIsLinearOverSixtyPowersOfTen) {
    test::SmallTree tree = test::ball_on_a_skeleton(300, 2, test::bright_leaf());
    for (bool ground : {false, true}) {
        if (ground)
            tree.scene.ground = Ground{0.5f};
        Environment environment = test::sky_and_sun();
        environment.remainder = constant_environment(glm::vec3(0)).remainder;
        environment.distant_lights[0].irradiance = glm::vec3(1);
        environment.point_lights = {{"lamp", {2, 2, 0}, glm::vec3(1)}};
        const double expected = test::mean(shade(tree, environment));
        for (float power : {1e-30f, 1e-20f, 1e20f, 1e30f}) {
            environment.distant_lights[0].irradiance = glm::vec3(power);
            environment.point_lights[0].intensity = glm::vec3(power);
            const Solution solution = shade(tree, environment);
            expect_finite(solution);
            EXPECT_NEAR(test::mean(solution) / double(power), expected, 0.002 * expected) << power;
        }
    }
}

TEST(BundlesStress, FaintAndBrightLightsTogether) {
    const test::SmallTree tree = test::ball_on_a_skeleton(200, 2, test::bright_leaf());
    Environment environment = test::sky_and_sun();
    DistantLight star = environment.distant_lights[0];
    star.direction = {0, 1, 0};
    for (const glm::vec3& irradiance : {glm::vec3(1e-30f), glm::vec3(1e30f, 0, 1e-30f), glm::vec3(0)}) {
        star.irradiance = irradiance;
        environment.distant_lights.push_back(star);
    }
    expect_finite(shade(tree, environment));
}

TEST(BundlesStress, NothingAbsorbs) {
    test::SmallTree tree = test::ball_on_a_skeleton(1000, 5, test::grey_leaf(1));
    const Solution furnace = shade(tree, constant_environment(glm::vec3(1)));
    expect_finite(furnace);
    EXPECT_NEAR(test::mean(furnace), 1, 1e-3);
    tree.scene.ground = Ground{0.9f, glm::vec3(1)};
    expect_finite(shade(tree, test::sky_and_sun()));
}

TEST(BundlesStress, AnOpaqueBlackTree) {
    const test::SmallTree tree = test::ball_on_a_skeleton(300, 3, {glm::vec3(0), glm::vec3(0)});
    const Solution solution = shade(tree, test::sky_and_sun());
    expect_finite(solution);
    EXPECT_EQ(test::mean(solution), 0);
    EXPECT_NEAR(solution.energy_absorbed / solution.energy_in, 1, 0.03);
}

TEST(BundlesStress, LampsInsideLeavesAndAtTheGround) {
    test::SmallTree tree = test::ball_on_a_skeleton(50, 2, test::bright_leaf());
    tree.scene.ground = Ground{0.9f};
    Environment environment = constant_environment(glm::vec3(0.1f));
    environment.point_lights = {{"in a leaf", tree.tree.leaves[0].centre, glm::vec3(1)},
                                {"at a corner", tree.scene.positions[0], glm::vec3(1)},
                                {"on the ground", {0, 0.9f, 0}, glm::vec3(1)},
                                {"far away", {1e9f, 1e9f, 0}, glm::vec3(1e18f)}};
    expect_finite(shade(tree, environment));
}

TEST(BundlesStress, AnyNumberOfDirections) {
    const test::SmallTree tree = test::ball_on_a_skeleton(100, 2, test::bright_leaf());
    for (int directions : {1, 2, 3, 5, 7, 33, 1000})
        expect_finite(shade(tree, test::sky_and_sun(), directions));
}

TEST(BundlesStress, ManyTinyLeavesAndAFewHuge) {
    test::SmallTree tree = test::ball_on_a_skeleton(2000, 0.001f, test::realistic_leaf());
    test::add_rectangle(tree.scene, {-3, 2, -3}, {6, 0, 0}, {0, 0, 6});
    tree.tree.leaves.push_back({{0, 2, 0}, -1});
    expect_finite(shade(tree, test::sky_and_sun()));
}

// Above 2^20 faces, which leave fewer than 12 bits of a raster's keys for depth.
TEST(BundlesStress, OverAMillionLeaves) {
    constexpr std::uint32_t kLeaves = 1100000;
    test::SmallTree tree;
    tree.scene = test::random_crown(kLeaves, 6, test::realistic_leaf());
    const Solution solution = shade(tree, test::sky_and_sun(), 12);
    expect_finite(solution);
    EXPECT_NEAR((solution.energy_absorbed + solution.energy_escaped) / solution.energy_in, 1, 0.02);
    EXPECT_LT(solution.transport_bytes, 300ull * kLeaves);
    EXPECT_LT(*solution.estimated_error, 0.2);
    EXPECT_LT(solution.residuals.back(), 0.02);
    // As bright as a crown of the same shape and leaf area with a hundredth of the leaves: inside, light is the same.
    tree.scene = test::random_crown(kLeaves / 100, 6, test::realistic_leaf());
    const double expected = test::mean(shade(tree, test::sky_and_sun(), 40));
    EXPECT_NEAR(test::mean(solution), expected, 0.02 * expected);
}

// Rays for a whole crown: all leaves are tiny beside one wide card.
TEST(BundlesStress, AHundredThousandTinyLeavesBesideAWideCard) {
    test::SmallTree tree;
    tree.scene = test::random_crown(100000, 3, test::grey_leaf(1));
    test::add_rectangle(tree.scene, {-300, 0, -300}, {0, 0, 600}, {600, 0, 0});
    const Solution furnace = shade(tree, constant_environment(glm::vec3(1)), 4);
    expect_finite(furnace);
    EXPECT_NEAR(test::mean(furnace), 1, 1e-4);
    EXPECT_TRUE(std::any_of(furnace.report.counts.begin(), furnace.report.counts.end(), [](const auto& count) {
        return count.name == "leaves too small for lines" && count.value == 100000;
    }));
}

} // namespace
} // namespace kokage

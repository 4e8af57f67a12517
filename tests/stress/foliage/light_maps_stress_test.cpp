// Extremes that must stay finite, and where physics says so, stay the same.
#include "tests/unit/foliage/shade_small_trees.h"
#include "tests/unit/foliage/solution_checks.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

class MapMethods : public testing::TestWithParam<Method> {
  protected:
    static Solution shade(const test::SmallTree& small, const Environment& environment, int bands = 7) {
        ShadingOptions options;
        options.method = GetParam();
        options.bands = bands;
        return test::shade(small, environment, options);
    }
};
INSTANTIATE_TEST_SUITE_P(Both, MapMethods, testing::Values(Method::paper, Method::light_maps));

TEST_P(MapMethods, TreesOfAnySizeAreLitAlike) {
    const test::SmallTree tree = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    const double expected = test::mean(shade(tree, test::sky_and_sun()));
    for (float scale : {1e-6f, 1e-3f, 1e3f, 1e6f}) {
        const Solution solution = shade(test::transformed(tree, scale, glm::vec3(0)), test::sky_and_sun());
        test::expect_finite(solution);
        EXPECT_NEAR(test::mean(solution), expected, 0.02 * expected) << scale;
    }
}

TEST_P(MapMethods, FarFromTheOriginNothingBreaks) {
    const test::SmallTree tree = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    test::expect_finite(shade(test::transformed(tree, 1, {1e7f, 0, -1e7f}), test::sky_and_sun()));
}

TEST_P(MapMethods, LightIsLinearOverSixtyPowersOfTen) {
    const test::SmallTree tree = test::ball_on_a_skeleton(300, 2, test::bright_leaf());
    Environment environment = test::sky_and_sun();
    environment.remainder = constant_environment(glm::vec3(0)).remainder;
    environment.distant_lights[0].irradiance = glm::vec3(1);
    const double expected = test::mean(shade(tree, environment));
    for (float power : {1e-30f, 1e30f}) {
        environment.distant_lights[0].irradiance = glm::vec3(power);
        const Solution solution = shade(tree, environment);
        test::expect_finite(solution);
        EXPECT_NEAR(test::mean(solution) / double(power), expected, 1e-4 * expected);
    }
}

TEST_P(MapMethods, AnyNumberOfBands) {
    const test::SmallTree tree = test::ball_on_a_skeleton(100, 2, test::bright_leaf());
    for (int bands : {1, 2, 3, 8, 20, 40})
        test::expect_finite(shade(tree, test::sky_and_sun(), bands));
}

TEST_P(MapMethods, CoincidentAndEmptyLeavesAndBlackSkies) {
    test::SmallTree tree = test::ball_on_a_skeleton(50, 2, test::grey_leaf(1));
    test::add_coincident_and_empty_leaves(tree);
    test::expect_finite(shade(tree, test::sky_and_sun()));
    const Solution black = shade(tree, constant_environment(glm::vec3(0)));
    test::expect_finite(black);
    EXPECT_EQ(test::mean(black), 0);
}

TEST_P(MapMethods, ALampInsideALeafAndAtAMap) {
    const test::SmallTree tree = test::ball_on_a_skeleton(50, 2, test::bright_leaf());
    Environment environment = constant_environment(glm::vec3(0.1f));
    const Leaf& leaf = tree.tree.leaves[0];
    environment.point_lights = {{"at a leaf", leaf.centre, glm::vec3(1)},
                                {"at a map", tree.tree.skeleton.branches[1].nodes[0].position, glm::vec3(1)}};
    test::expect_finite(shade(tree, environment));
}

} // namespace
} // namespace kokage

// How fast the sweeps of `bundles` die out, on fixed scenes with stored figures. A change here means that the operator
// has changed: look why before storing another.
#include "foliage/method.h"
#include "tests/unit/foliage/rooms.h"
#include "tests/unit/foliage/shade_small_trees.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

Solution bounce(const test::SmallTree& small, const Environment& environment, int max_bounces, double error = 0.05) {
    ShadingOptions options;
    options.method = Method::bundles;
    options.effort = 80;
    options.error = error;
    options.max_bounces = max_bounces;
    return test::shade(small, environment, options);
}

test::SmallTree crown(float albedo) {
    return test::ball_on_a_skeleton(2000, 3, test::grey_leaf(albedo));
}

/// Mean factor from bounce to bounce over bounces 5 to 9, when one pattern of light is left.
double rate(const Solution& solution) {
    return std::pow(solution.residuals[8] / solution.residuals[4], 0.25);
}

// The operator is the albedo times geometry. The factor is above what light maps find (0.56, a blurred crown): links
// keep the middle of the crown, where hardly any light gets out, apart from its rim.
TEST(IterationConvergence, BundlesContractByLessThanTheAlbedo) {
    const Solution half = bounce(crown(0.5f), test::sky_and_sun(), 12),
                   white = bounce(crown(1), test::sky_and_sun(), 12);
    EXPECT_EQ(white.residuals.size(), 13u) << "twelve scatterings on the way, and the leaf's own";
    EXPECT_LT(rate(half), 0.5);
    EXPECT_NEAR(rate(white), 2 * rate(half), 0.06);
    EXPECT_NEAR(rate(white), 0.608, 0.01);
}

TEST(IterationConvergence, BundlesResidualsFallFromBounceToBounce) {
    const Solution solution = bounce(crown(0.9f), test::sky_and_sun(), 20);
    EXPECT_EQ(solution.residuals.front(), 1) << "from black to the first shading";
    for (std::size_t i = 1; i < solution.residuals.size(); ++i)
        EXPECT_LT(solution.residuals[i], solution.residuals[i - 1]) << i;
}

// In a closed room nothing gets out. A lamp of power 1 then gives 1 + a + a^2 + ..., so the residual of bounce k is
// a^k (1 - a) / (1 - a^(k+1)) once light has mixed.
TEST(IterationConvergence, InAClosedRoomBundlesFollowTheGeometricSeries) {
    const double a = 0.9;
    Environment lamp = constant_environment(glm::vec3(0));
    lamp.point_lights = {{"lamp", {1.3f, 3.3f, 1.3f}, glm::vec3(1)}};
    const Solution solution = bounce(test::crown_in_a_room(400, test::grey_leaf(float(a))), lamp, 41);
    const double factor = solution.residuals[40] / solution.residuals[30];
    EXPECT_NEAR(factor, std::pow(a, 10) * (1 - std::pow(a, 31)) / (1 - std::pow(a, 41)), 0.01);
}

// Sweeps until the tolerance: what a user waits for. Where nothing absorbs the last change must be below 7.5e-5 (0.025
// x 0.003); plain sweeps, each 0.61 of the one before, would need 20.
TEST(IterationConvergence, BundlesNeedFewSweepsHoweverBrightTheLeaves) {
    const int stored[] = {4, 4, 7, 8};
    const float albedos[] = {0.5f, 0.9f, 0.99f, 1};
    for (std::size_t i = 0; i < 4; ++i) {
        const Solution solution = bounce(crown(albedos[i]), test::sky_and_sun(), 0);
        EXPECT_NEAR(double(solution.residuals.size()), stored[i], 1) << albedos[i];
    }
}

} // namespace
} // namespace kokage

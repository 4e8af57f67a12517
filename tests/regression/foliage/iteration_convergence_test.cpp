// How fast bounces die out, on fixed scenes with stored figures. A change here means that the operator has changed:
// look why before storing another.
#include "tests/unit/foliage/rooms.h"
#include "tests/unit/foliage/shade_small_trees.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// Residuals of 12 bounces.
Solution bounce(Method method, const test::SmallTree& small, GatherRule gather = GatherRule::cosine) {
    ShadingOptions options;
    options.method = method;
    options.gather = gather;
    options.maps = 15;
    options.max_bounces = 12;
    return test::shade(small, test::sky_and_sun(), options);
}

/// Mean factor from bounce to bounce over bounces 3 to 6: late enough that one pattern of light is left (the operator's
/// largest eigenvalue), early enough for changes to be no rounding.
double rate(const Solution& solution) {
    return std::pow(solution.residuals[6] / solution.residuals[2], 0.25);
}

test::SmallTree crown(float albedo) {
    return test::ball_on_a_skeleton(2000, 3, test::grey_leaf(albedo));
}

// The uniform mean over all maps passes on what one mean leaf would: the share of capture rays that meet leaves, times
// the albedo.
TEST(IterationConvergence, PaperContractsByTheShareOfTheCrownThatItsMapsSee) {
    const Solution grey = bounce(Method::paper, crown(0.5f)), white = bounce(Method::paper, crown(1));
    EXPECT_EQ(grey.residuals.size(), 13u);
    EXPECT_NEAR(rate(white), 2 * rate(grey), 0.04) << "the operator is the albedo times geometry";
    EXPECT_NEAR(rate(white), 0.374, 0.01);
    EXPECT_TRUE(grey.report.warnings.empty());
}

// Never slower than the albedo, and faster by as much as light gets out of the crown. (With first light by 16 rays a
// side the rates were 0.596 and 0.562: the root of a share is the smaller the noisier the share is.)
TEST(IterationConvergence, LightMapsContractByLessThanTheAlbedo) {
    for (const GatherRule gather : {GatherRule::rule, GatherRule::cosine}) {
        const Solution half = bounce(Method::light_maps, crown(0.5f), gather),
                       white = bounce(Method::light_maps, crown(1), gather);
        EXPECT_LT(rate(half), 0.5);
        EXPECT_LT(rate(white), 1);
        EXPECT_NEAR(rate(white), 2 * rate(half), 0.04);
        EXPECT_NEAR(rate(white), gather == GatherRule::rule ? 0.616 : 0.565, 0.01);
    }
}

TEST(IterationConvergence, ResidualsFallFromBounceToBounce) {
    for (const Method method : {Method::paper, Method::light_maps}) {
        const Solution solution = bounce(method, crown(0.9f));
        EXPECT_EQ(solution.residuals.front(), 1) << "from black to the first shading";
        for (std::size_t i = 1; i < solution.residuals.size(); ++i)
            EXPECT_LT(solution.residuals[i], solution.residuals[i - 1]) << i;
    }
}

// In a closed room nothing gets out. A lamp of power 1 then gives 1 + a + a^2 + ..., so the residual of bounce k is
// a^k (1 - a) / (1 - a^(k+1)) once light has mixed.
TEST(IterationConvergence, InAClosedRoomLightMapsFollowTheGeometricSeries) {
    const double a = 0.9;
    test::SmallTree room = test::crown_in_a_room(400, test::grey_leaf(float(a)));
    Environment lamp = constant_environment(glm::vec3(0));
    lamp.point_lights = {{"lamp", {0, 4.2f, 0}, glm::vec3(1)}};
    ShadingOptions options;
    options.method = Method::light_maps;
    options.maps = 15;
    options.max_bounces = 40;
    const Solution solution = test::shade(room, lamp, options);
    const double factor = solution.residuals[40] / solution.residuals[30];
    EXPECT_NEAR(factor, std::pow(a, 10) * (1 - std::pow(a, 31)) / (1 - std::pow(a, 41)), 0.03);
}

// A closed room that absorbs nothing, with a lamp in it: every bounce adds as much as the one before, for ever.
TEST(IterationConvergence, ASettingThatDoesNotContractIsSaidPlainly) {
    test::SmallTree room;
    room.scene.optics = {{glm::vec3(1), glm::vec3(0)}};
    test::add_box(room.scene, {0, 0, 0}, 1);
    test::add_branch(room.tree.skeleton, -1, {0, -1, 0}, {0, 0, 0});
    test::add_branch(room.tree.skeleton, 0, {0, 0, 0}, {0.1f, 0, 0}); // the one map, in the middle
    room.tree.leaves = {{{10, 0, 0}, 1}};                             // its sphere holds all walls
    Environment lamp = constant_environment(glm::vec3(0));
    lamp.point_lights = {{"lamp", {0.2f, 0.5f, 0}, glm::vec3(1)}};
    for (const Method method : {Method::paper, Method::light_maps}) {
        ShadingOptions options;
        options.method = method;
        const Solution solution = test::shade(room, lamp, options);
        // The relative change falls as 1/k all the same: the default stops below 0.005, but says that there is no
        // limit.
        ASSERT_FALSE(solution.report.warnings.empty());
        EXPECT_NE(solution.report.warnings.back().find("does not contract"), std::string::npos)
            << solution.report.warnings.back();
        for (const glm::vec3& value : solution.radiance.front)
            EXPECT_TRUE(std::isfinite(value.r));
    }
}

} // namespace
} // namespace kokage

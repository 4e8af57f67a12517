// Surfaces much wider than leaves, which get rays in place of lines, and lights that are wide.
#include "foliage/accuracy.h"
#include "foliage/bundles/bundle_tracing.h"
#include "foliage/bundles/effort.h"
#include "foliage/bundles/outside_light.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/shade_small_trees.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <string>

namespace kokage {
namespace {

using namespace bundles;

/// A ball of leaves ten metres above the middle of a floor of 2 x 2 pieces, 40 m wide in all.
test::SmallTree ball_above_a_floor(std::uint32_t leaves, const Optics& leaf, const Optics& floor) {
    test::SmallTree small = test::ball_on_a_skeleton(leaves, 3, leaf);
    small.scene.optics.push_back(floor);
    for (float x : {-20.f, 0.f})
        for (float z : {-20.f, 0.f}) {
            test::add_rectangle(small.scene, {x, -8, z}, {0, 0, 20}, {20, 0, 0}, 1); // fronts are +Y
            small.scene.patches.back().kind = PatchKind::bark;
            --small.scene.leaf_count;
        }
    return small;
}

std::uint64_t counted(const Solution& solution, const std::string& name) {
    for (const WorkReport::Count& count : solution.report.counts)
        if (count.name == name)
            return count.value;
    return 0;
}

Solution shade_wide(const test::SmallTree& small, const Environment& environment, int directions) {
    ShadingOptions options;
    options.effort = directions;
    return test::shade(small, environment, options);
}

double error_of(const PatchScene& scene, const Solution& solution, const PathTracedReference& reference) {
    std::vector<double> areas = solid_areas(scene);
    areas.resize(scene.leaf_count); // every leaf is a patch, and leaves come first
    return accuracy(leaf_side_radiance(scene, solution.radiance), reference.sides, areas).mre;
}

constexpr Optics kPaper{glm::vec3(0.6f), glm::vec3(0)};

TEST(BundlesWideSurfaces, AreThoseThatLinesWouldMostlyBeDrawnOn) {
    test::SmallTree small = ball_above_a_floor(200, test::realistic_leaf(), kPaper);
    const Facets facets = make_facets(small.scene);
    EXPECT_EQ(facets.wide_patches, (std::vector<std::uint32_t>{200, 201, 202, 203}));
    const glm::vec3 size = (facets.drawn.high - facets.drawn.low) / float(facets.scale);
    EXPECT_LT(std::max({size.x, size.y, size.z}), 3); // the ball's

    small.scene.ground = Ground{}; // which they shade beyond where lines are drawn
    EXPECT_TRUE(make_facets(small.scene).wide_patches.empty());

    const PatchScene crown = test::random_crown(200, 3, test::realistic_leaf());
    const Facets plain = make_facets(crown);
    EXPECT_TRUE(plain.wide_patches.empty());
    EXPECT_EQ(plain.drawn.low, plain.low);
    EXPECT_EQ(plain.drawn.high, plain.high);
}

TEST(BundlesWideSurfaces, CostLittleMoreThanTheTreeAlone) {
    const Solution alone =
        shade_wide(test::ball_on_a_skeleton(2000, 3, test::realistic_leaf()), test::sky_and_sun(), 40);
    const Solution above =
        shade_wide(ball_above_a_floor(2000, test::realistic_leaf(), kPaper), test::sky_and_sun(), 40);
    EXPECT_EQ(counted(alone, "surfaces too wide for lines"), 0u);
    EXPECT_EQ(counted(above, "surfaces too wide for lines"), 4u);
    EXPECT_EQ(counted(above, "rays from wide surfaces"), 4u * 8 * 40);
    EXPECT_LT(counted(above, "fragments"), 3 * counted(alone, "fragments")); // all drawn: 60 times
}

TEST(BundlesWideSurfaces, LeavesAboveAFloorComeNearTheTruth) {
    const test::SmallTree small = ball_above_a_floor(500, test::realistic_leaf(), kPaper);
    const Environment environment = test::sky_and_sun();
    const PathTracedReference reference = path_trace_reference(small.scene, environment, 1024, 1, silent_progress());
    const Solution solution = shade_wide(small, environment, 160);
    const double error = error_of(small.scene, solution, reference);
    // A ball of 2 m hides next to nothing from pieces of 20 m.
    const DistantLight& sun = environment.distant_lights[0];
    const glm::vec3 open =
        kPaper.reflectance / kPi * (horizontal_irradiance(environment.remainder) + sun.irradiance * sun.direction.y);
    EXPECT_LT(error, 0.04);
    for (std::size_t piece = 0; piece < 4; ++piece)
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(solution.radiance.front[500 + piece][c] / open[c], 1, 0.02);
        }
}

TEST(BundlesWideSurfaces, AFurnaceIsOneEverywhere) {
    const test::SmallTree small =
        ball_above_a_floor(300, {glm::vec3(0.5f), glm::vec3(0.5f)}, {glm::vec3(1), glm::vec3(0)});
    const Solution solution = shade_wide(small, constant_environment(glm::vec3(1)), 20);
    ASSERT_EQ(counted(solution, "surfaces too wide for lines"), 4u);
    for (const auto* side : {&solution.radiance.front, &solution.radiance.back})
        for (const glm::vec3& value : *side)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(value[c], 1, 1e-3);
}

/// A disc that alone gives light.
Environment lamp(float half_angle) {
    Environment environment = constant_environment(glm::vec3(0));
    DistantLight light;
    light.direction = glm::normalize(glm::vec3(1, 2, 0.5f));
    light.half_angle = half_angle;
    light.irradiance = glm::vec3(5);
    environment.distant_lights = {light};
    return environment;
}

TEST(BundlesWideLights, GetManyBeamsOfFewPixels) {
    BundleEffort effort;
    effort.light_samples = 96;
    const LightPlan sun = plan_lights(lamp(0.0047f), effort, 0), window = plan_lights(lamp(0.4f), effort, 0),
                    spot = plan_lights(lamp(0.06f), effort, 0);
    ASSERT_EQ(sun.drawn.size(), 1u);
    EXPECT_EQ(sun.drawn[0].beams, 2);
    EXPECT_EQ(window.drawn.at(0).beams, 32);
    EXPECT_EQ(spot.drawn.at(0).beams, 4); // more would all see the same
    for (const LightPlan* plan : {&sun, &window, &spot})
        EXPECT_NEAR(float(plan->drawn[0].beams) * plan->drawn[0].pixels, 96, 1e-3);
    // A region whose light comes from one of its texels is as narrow as that.
    Environment region = lamp(0.4f);
    region.distant_lights[0].texels = {{{0, 1, 0}, glm::vec3(5), 0.01f}, {{0.4f, 0.9f, 0}, glm::vec3(0.01f), 0.1f}};
    EXPECT_EQ(plan_lights(region, effort, 0).drawn.at(0).beams, 2);
}

TEST(BundlesWideLights, ComeNearTheTruth) {
    const test::SmallTree small = test::ball_on_a_skeleton(1000, 3, test::realistic_leaf());
    const Environment environment = lamp(0.4f);
    const PathTracedReference reference = path_trace_reference(small.scene, environment, 1024, 1, silent_progress());
    const Solution solution = shade_wide(small, environment, 80);
    const double error = error_of(small.scene, solution, reference);
    EXPECT_LT(error, 0.1); // by two beams: 21 %
    EXPECT_LT(*solution.estimated_error / error, 1.5);
    EXPECT_GT(*solution.estimated_error / error, 1 / 1.5);
}

} // namespace
} // namespace kokage

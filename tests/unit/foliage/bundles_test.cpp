// The method `bundles` as a whole: against the truth, and what relighting, threads and lamps must not change.
#include "common/services/parallel.h"
#include "foliage/accuracy.h"
#include "foliage/bundles/bundles.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/rooms.h"
#include "tests/unit/foliage/shade_small_trees.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

ShadingOptions bundles_options(int directions = 0) {
    ShadingOptions options;
    options.method = Method::bundles;
    options.effort = directions;
    return options;
}

using test::shade;

double largest_side_difference(const SideRadiance& a, const SideRadiance& b) {
    double difference = 0, largest = 0;
    for (const auto& [x, y] : {std::pair(&a.front, &b.front), std::pair(&a.back, &b.back)})
        for (std::size_t p = 0; p < x->size(); ++p)
            for (std::size_t c = 0; c < 3; ++c) {
                difference = std::max(difference, std::abs(double((*x)[p][c]) - double((*y)[p][c])));
                largest = std::max(largest, double((*y)[p][c]));
            }
    return difference / largest;
}

TEST(Bundles, ALoneLeafUnderSunAndSkyIsExact) {
    test::SmallTree lone;
    lone.scene.optics = {test::realistic_leaf()};
    test::add_rectangle(lone.scene, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0}); // front is +Y
    Environment environment = constant_environment({1, 2, 3});
    DistantLight sun;
    sun.direction = {0.6f, 0.8f, 0};
    sun.irradiance = {10, 9, 8};
    environment.distant_lights = {sun};
    const Solution solution = shade(lone, environment, bundles_options(40));
    const glm::vec3 sky = kPi * glm::vec3(1, 2, 3), direct = 0.8f * sun.irradiance;
    const glm::vec3 rho = test::realistic_leaf().reflectance, tau = test::realistic_leaf().transmittance;
    const glm::vec3 front = (rho * (sky + direct) + tau * sky) / kPi, back = (rho * sky + tau * (sky + direct)) / kPi;
    EXPECT_LT(glm::distance(solution.radiance.front[0], front), 1e-3f * glm::length(front));
    EXPECT_LT(glm::distance(solution.radiance.back[0], back), 1e-3f * glm::length(back));
    EXPECT_NEAR(solution.indirect.front[0].g, (rho + tau).g * 2, 2e-3);
    EXPECT_NEAR(solution.sky_visibility_front[0], 1, 1e-4);
}

// Most lines miss a small leaf, and of those that run along it more than of those that cross it.
TEST(Bundles, ASmallLeafSeesTheSkyAboveTheHorizon) {
    test::SmallTree two;
    two.scene.optics = {test::realistic_leaf()};
    const glm::vec3 across(0, 0, 1), up = glm::normalize(glm::vec3(1, 1, 0)); // tilted by 45 degrees
    test::add_rectangle(two.scene, {0, 5, 0}, 0.15f * across, 0.15f * up);
    test::add_rectangle(two.scene, {40, 5, 0}, across, up);
    two.scene.ground = Ground{};
    const Solution solution = shade(two, test::sky_and_sun(), bundles_options(20480));
    const float tilt = std::sqrt(0.5f); // a side sees (1 + cosine of its tilt) / 2 of the sky
    EXPECT_NEAR(std::min(solution.sky_visibility_front[0], solution.sky_visibility_back[0]), (1 - tilt) / 2, 0.006);
    EXPECT_NEAR(std::max(solution.sky_visibility_front[0], solution.sky_visibility_back[0]), (1 + tilt) / 2, 0.006);
}

TEST(Bundles, AFurnaceIsOneEverywhere) {
    test::SmallTree small = test::ball_on_a_skeleton(2600, 3, {{0.5f, 0.9f, 0}, {0.5f, 0.1f, 1}});
    ShadingOptions options = bundles_options(40);
    const Solution solution = shade(small, constant_environment(glm::vec3(1)), options);
    double mean = 0, largest = 0;
    for (const auto* side : {&solution.radiance.front, &solution.radiance.back})
        for (const glm::vec3& value : *side)
            for (std::size_t c = 0; c < 3; ++c) {
                mean += std::abs(double(value[c]) - 1) / double(6 * side->size());
                largest = std::max(largest, std::abs(double(value[c]) - 1));
            }
    EXPECT_LT(mean, 0.001);
    EXPECT_LT(largest, 0.005);
    ASSERT_TRUE(solution.estimated_error);
    EXPECT_LT(*solution.estimated_error, 0.003) << "where light is even, one radiance a side is no error";
}

TEST(Bundles, EnergyBalancesInTheOpen) {
    for (float albedo : {0.5f, 0.9f, 0.99f, 1.f}) {
        const test::SmallTree small = test::ball_on_a_skeleton(1000, 3, test::grey_leaf(albedo));
        const Solution solution = shade(small, test::sky_and_sun(), bundles_options(80));
        EXPECT_NEAR((solution.energy_absorbed + solution.energy_escaped) / solution.energy_in, 1, 0.03) << albedo;
        EXPECT_LT(solution.residuals.back(), 0.02);
    }
}

TEST(Bundles, EnergyBalancesInAClosedRoom) {
    Environment lamp = constant_environment(glm::vec3(0));
    lamp.point_lights = {{"lamp", {1.3f, 3.3f, 1.3f}, glm::vec3(1)}}; // not near a wall, whose samples are few
    for (float albedo : {0.5f, 0.9f, 0.99f}) {
        const test::SmallTree room = test::crown_in_a_room(300, test::grey_leaf(albedo));
        ShadingOptions options = bundles_options(80);
        options.error = 0.01;
        const Solution solution = shade(room, lamp, options);
        EXPECT_NEAR(solution.energy_in, 4 * kPiDouble, 0.1 * 4 * kPiDouble) << "the lamp's whole power";
        EXPECT_NEAR(solution.energy_absorbed / solution.energy_in, 1, 0.05) << albedo;
        EXPECT_LT(solution.energy_escaped, 0.05 * solution.energy_in) << albedo;
    }
    // Nothing absorbs and nothing gets out: there is no balance to reach, but numbers stay finite and changes fall.
    const Solution white = shade(test::crown_in_a_room(300, test::grey_leaf(1)), lamp, bundles_options(20));
    EXPECT_TRUE(std::isfinite(white.energy_absorbed + white.energy_escaped));
    EXPECT_LT(white.residuals.back(), white.residuals.front());
    for (const glm::vec3& value : white.radiance.front)
        ASSERT_TRUE(std::isfinite(value.r));
}

test::SmallTree card_tree() {
    test::SmallTree small = test::ball_on_a_skeleton(150, 4, test::realistic_leaf(), 3);
    test::mask_rectangles(small.scene, test::checkered_mask(4));
    return small;
}

/// Cards of thin needles: a sixth is solid, and hardly two pixels of a coarse raster hang together.
test::SmallTree needle_tree() {
    test::SmallTree small = test::ball_on_a_skeleton(150, 8, test::realistic_leaf(), 3);
    auto alpha = std::make_shared<Image>(96, 96, 1);
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x)
            alpha->at(x, y)[0] = (x + y) % 12 < 2 ? 1.f : 0.f;
    AlphaMask mask;
    mask.alpha = alpha;
    test::mask_rectangles(small.scene, mask);
    return small;
}

// Steep directions count as much as they should, however few pixels they cover.
TEST(Bundles, NeedlesSeeTheSkyWithoutBias) {
    const test::SmallTree small = needle_tree();
    const Environment sky = constant_environment(glm::vec3(1));
    const PathTracedReference reference = path_trace_reference(small.scene, sky, 1024, 1, silent_progress());
    const Solution solution = shade(small, sky, bundles_options(400));
    const Accuracy found =
        accuracy(leaf_side_radiance(small.scene, solution.radiance), reference.sides, solid_areas(small.scene));
    EXPECT_LT(found.mre, 0.03);
    EXPECT_NEAR(found.bias, 0, 0.004);
}

struct Truth {
    const char* name;
    test::SmallTree small;
    double mre, bias; ///< with 80 directions
};

TEST(Bundles, ComesNearTheTruthAndKnowsHowNear) {
    const Truth truths[] = {{"realistic ball", test::ball_on_a_skeleton(300, 3, test::realistic_leaf()), 0.035, 0.015},
                            {"bright ball", test::ball_on_a_skeleton(600, 3, test::bright_leaf(), 2), 0.035, 0.015},
                            {"cards", card_tree(), 0.045, 0.015},
                            {"needles", needle_tree(), 0.045, 0.015}};
    for (const Truth& truth : truths) {
        SCOPED_TRACE(truth.name);
        const Environment environment = test::sky_and_sun();
        const PathTracedReference reference =
            path_trace_reference(truth.small.scene, environment, 1024, 1, silent_progress());
        const Solution solution = shade(truth.small, environment, bundles_options(80));
        const Accuracy found = accuracy(leaf_side_radiance(truth.small.scene, solution.radiance), reference.sides,
                                        solid_areas(truth.small.scene));
        EXPECT_LT(found.mre, truth.mre);
        EXPECT_NEAR(found.bias, 0, truth.bias);
        const double own = std::sqrt(std::max(found.mre * found.mre - reference.noise * reference.noise, 1e-8));
        ASSERT_TRUE(solution.estimated_error);
        EXPECT_GT(*solution.estimated_error / own, 1 / 1.5);
        EXPECT_LT(*solution.estimated_error / own, 1.5);
    }
}

// A bounce is a scattering between the light and the leaf that is looked at, in every method.
TEST(Bundles, CountedBouncesAreThoseOfPaths) {
    const test::SmallTree small = test::ball_on_a_skeleton(200, 4, test::bright_leaf());
    for (int bounces : {1, 2, 4}) {
        ShadingOptions lines = bundles_options(300), paths;
        lines.max_bounces = paths.max_bounces = bounces;
        paths.method = Method::path_traced;
        paths.effort = 800;
        const Solution truth = shade(small, test::sky_and_sun(), paths);
        const Solution solution = shade(small, test::sky_and_sun(), lines);
        const Accuracy found = accuracy(leaf_side_radiance(small.scene, solution.radiance),
                                        leaf_side_radiance(small.scene, truth.radiance), solid_areas(small.scene));
        EXPECT_NEAR(found.bias, 0, 0.03) << bounces; // one too few: 0.07 and more
    }
}

TEST(Bundles, ErrorFallsWithEffort) {
    const test::SmallTree small = test::ball_on_a_skeleton(500, 3, test::realistic_leaf());
    double before = 1;
    for (int directions : {20, 80, 320}) {
        const double error = *shade(small, test::sky_and_sun(), bundles_options(directions)).estimated_error;
        EXPECT_LT(error, 0.7 * before) << directions;
        before = error;
    }
}

TEST(Bundles, RelightingGivesWhatAFreshSolveGives) {
    const test::SmallTree small = test::ball_on_a_skeleton(500, 3, test::realistic_leaf());
    const auto transport = make_transport(small.scene, small.tree, bundles_options(40), silent_progress());
    Environment environment = test::sky_and_sun();
    transport->solve(environment, silent_progress());
    constexpr double kTolerance = 0.003;       // of the largest radiance: sweeps stop a little apart,
    constexpr double kBrightTolerance = 0.012; // further where light bounces long

    environment.distant_lights[0].direction = {0, 1, 0};
    EXPECT_LT(largest_side_difference(transport->solve(environment, silent_progress()).radiance,
                                      shade(small, environment, bundles_options(40)).radiance),
              kTolerance);
    environment.remainder = constant_environment({3, 2, 1}).remainder;
    environment.distant_lights[0].irradiance = {1, 0, 20};
    EXPECT_LT(largest_side_difference(transport->solve(environment, silent_progress()).radiance,
                                      shade(small, environment, bundles_options(40)).radiance),
              kTolerance);
    environment.distant_lights.clear();
    const auto fresh = make_transport(small.scene, small.tree, bundles_options(40), silent_progress());
    for (Transport* repainted : {transport.get(), fresh.get()})
        repainted->set_optics({test::bright_leaf()});
    EXPECT_LT(largest_side_difference(transport->solve(environment, silent_progress()).radiance,
                                      fresh->solve(environment, silent_progress()).radiance),
              kBrightTolerance);
}

TEST(Bundles, ADarkChannelOfALightComesBack) {
    const test::SmallTree small = test::ball_on_a_skeleton(100, 2, test::realistic_leaf());
    const auto transport = make_transport(small.scene, small.tree, bundles_options(20), silent_progress());
    Environment environment = test::sky_and_sun();
    environment.distant_lights[0].irradiance = {5, 5, 0};
    transport->solve(environment, silent_progress());
    environment.distant_lights[0].irradiance = {5, 5, 5};
    EXPECT_LT(largest_side_difference(transport->solve(environment, silent_progress()).radiance,
                                      shade(small, environment, bundles_options(20)).radiance),
              0.003);
}

TEST(Bundles, TheGroundHidesLightsBelowTheHorizon) {
    test::SmallTree small = test::ball_on_a_skeleton(100, 2, test::realistic_leaf());
    small.scene.ground = Ground{};
    Environment environment = constant_environment(glm::vec3(0));
    environment.distant_lights = test::sky_and_sun().distant_lights;
    environment.distant_lights[0].direction = glm::normalize(glm::vec3(1, -0.5f, 0));
    environment.point_lights = {{"buried", {0, -1, 0}, glm::vec3(1)}};
    const Solution solution = shade(small, environment, bundles_options(20));
    EXPECT_EQ(solution.energy_in, 0);
    for (const glm::vec3& radiance : solution.radiance.front)
        EXPECT_EQ(radiance, glm::vec3(0));
}

// A light that was too weak to be drawn with care may be the sun at the next solve.
TEST(Bundles, AFaintLightThatGrowsIsDrawnAgain) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 3, test::realistic_leaf());
    const auto transport = make_transport(small.scene, small.tree, bundles_options(40), silent_progress());
    Environment environment = test::sky_and_sun();
    DistantLight lamp = environment.distant_lights[0];
    lamp.direction = {0, 1, 0};
    lamp.irradiance = glm::vec3(0.3f);
    environment.distant_lights.push_back(lamp);
    transport->solve(environment, silent_progress());
    environment.distant_lights[0].irradiance = glm::vec3(0.3f);
    environment.distant_lights[1].irradiance = glm::vec3(10);
    EXPECT_LT(largest_side_difference(transport->solve(environment, silent_progress()).radiance,
                                      shade(small, environment, bundles_options(40)).radiance),
              0.01); // the sun keeps its better raster
}

TEST(Bundles, DoesNotDependOnThreads) {
    test::SmallTree small = test::ball_on_a_skeleton(3000, 3, test::realistic_leaf());
    small.scene.ground = Ground{};
    Environment environment = test::sky_and_sun();
    environment.point_lights = {{"lamp", {1.5f, 2, 0}, glm::vec3(3)}};
    set_thread_count(1);
    const Solution one = shade(small, environment, bundles_options(20));
    for (int threads : {2, 5}) {
        set_thread_count(threads);
        const Solution more = shade(small, environment, bundles_options(20));
        EXPECT_EQ(one.radiance.front, more.radiance.front) << threads;
        EXPECT_EQ(one.radiance.back, more.radiance.back) << threads;
        EXPECT_EQ(one.residuals, more.residuals) << threads;
        EXPECT_EQ(one.estimated_error, more.estimated_error) << threads;
    }
    set_thread_count(0);
}

/// |bias| and MRE against paths, for odd lights.
void expect_near_truth(const test::SmallTree& small, const Environment& environment, double mre, double bias) {
    const PathTracedReference reference = path_trace_reference(small.scene, environment, 512, 1, silent_progress());
    const Solution solution = shade(small, environment, bundles_options(160));
    const Accuracy found =
        accuracy(leaf_side_radiance(small.scene, solution.radiance), reference.sides, solid_areas(small.scene));
    EXPECT_LT(found.mre, mre);
    EXPECT_NEAR(found.bias, 0, bias);
}

TEST(Bundles, ALampBesideTheCrown) {
    Environment environment = constant_environment(glm::vec3(0.05f));
    environment.point_lights = {{"lamp", {1.2f, 2.3f, 0.2f}, {5, 4, 3}}};
    expect_near_truth(test::ball_on_a_skeleton(300, 3, test::realistic_leaf()), environment, 0.075, 0.02);
}

TEST(Bundles, SixtyFourLights) {
    Environment environment = constant_environment(glm::vec3(0.1f));
    Random random(9);
    for (int i = 0; i < 64; ++i) {
        DistantLight light;
        light.direction = test::random_direction(random);
        light.half_angle = 0.02f;
        light.irradiance = glm::vec3(random.uniform(0.01f, 1));
        environment.distant_lights.push_back(light);
    }
    expect_near_truth(test::ball_on_a_skeleton(300, 3, test::realistic_leaf()), environment, 0.045, 0.01);
}

TEST(Bundles, TheGroundSendsLightUpAndLiesInTheShadow) {
    test::SmallTree small = test::ball_on_a_skeleton(300, 4, test::realistic_leaf());
    small.scene.ground = Ground{0.8f, glm::vec3(0.5f)};
    expect_near_truth(small, test::sky_and_sun(), 0.045, 0.015);
}

} // namespace
} // namespace kokage

// Odd scenes and lights: everything stays finite, and scale changes nothing.
#include "foliage/accuracy.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/rooms.h"
#include "tests/unit/foliage/solution_checks.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

Solution shade(const PatchScene& scene, const Environment& environment, int effort) {
    ShadingOptions options;
    options.method = Method::path_traced;
    options.effort = effort;
    return make_path_traced_transport(scene, Tree{}, options, silent_progress())->solve(environment, silent_progress());
}

void expect_finite(const Solution& solution) {
    test::expect_finite(solution);
    ASSERT_TRUE(solution.estimated_error);
}

TEST(PathTracedStress, NoLeavesAtAll) {
    PatchScene scene;
    expect_finite(shade(scene, test::sky_and_sun(), 8));
    scene.ground = Ground{};
    expect_finite(shade(scene, test::sky_and_sun(), 0));
    EXPECT_TRUE(path_trace_reference(scene, test::sky_and_sun(), 8, 1, silent_progress()).sides.empty());
}

TEST(PathTracedStress, CoincidentAndDegenerateLeaves) {
    PatchScene scene;
    scene.optics = {test::bright_leaf()};
    for (int i = 0; i < 3; ++i)
        test::add_rectangle(scene, {0, 1, 0}, {0, 0, 1}, {1, 0, 0});
    test::add_leaf(scene, {{0, 2, 0}, {0, 2, 0}, {0, 2, 0}});
    test::add_leaf(scene, {{0, 2, 0}, {1, 2, 0}, {2, 2, 0}});
    test::add_leaf(scene, {{0, 3, 0}, {1, 3, 0}, {0.5f, 3, 1e-12f}});
    test::add_leaf(scene, {});
    const Solution solution = shade(scene, test::sky_and_sun(), 64);
    expect_finite(solution);
    EXPECT_GT(solution.radiance.front[0].g, 0.1f);
    EXPECT_EQ(solution.radiance.front[3], glm::vec3(0)) << "no area, no light";
    EXPECT_EQ(solution.radiance.front[6], glm::vec3(0)) << "no triangles, no light";
}

TEST(PathTracedStress, ScaleAndPlaceChangeNothing) {
    const PatchScene scene = test::random_crown(200, 3.5f, test::bright_leaf());
    const double expected = test::mean(shade(scene, test::sky_and_sun(), 128));
    for (const float scale : {1e-6f / 3, 1e6f / 3}) {
        PatchScene scaled = scene;
        for (glm::vec3& position : scaled.positions)
            position *= scale;
        const Solution solution = shade(scaled, test::sky_and_sun(), 128);
        expect_finite(solution);
        EXPECT_NEAR(test::mean(solution), expected, 0.005 * expected) << scale;
    }
    for (const float away : {1e3f, 1e7f}) { // at 1e7 m, float keeps one metre of the crown
        PatchScene moved = scene;
        for (glm::vec3& position : moved.positions)
            position += glm::vec3(away, 0, -away);
        const Solution solution = shade(moved, test::sky_and_sun(), 128);
        expect_finite(solution);
        if (away < 1e4f) {
            EXPECT_NEAR(test::mean(solution), expected, 0.02 * expected);
        }
    }
}

TEST(PathTracedStress, LightsOfAnyStrength) {
    const PatchScene scene = test::random_crown(100, 3.5f, test::bright_leaf());
    double first = 0;
    for (const float power : {1e-30f, 1.f, 1e30f}) {
        Environment environment = constant_environment(glm::vec3(0));
        environment.distant_lights = test::sky_and_sun().distant_lights;
        environment.distant_lights[0].irradiance = glm::vec3(power);
        const Solution solution = shade(scene, environment, 16);
        expect_finite(solution);
        const double relative = test::mean(solution) / double(power);
        first = first > 0 ? first : relative;
        EXPECT_NEAR(relative / first, 1, 1e-4) << power;
    }
    // A candle beside a star, and a lamp in the plane of a leaf.
    Environment both = test::sky_and_sun();
    both.distant_lights[0].irradiance = glm::vec3(1e30f);
    both.point_lights = {{"candle", {0.5f, 2.5f, 0}, glm::vec3(1e-30f)},
                         {"on a leaf", scene.positions[0], glm::vec3(1)}};
    expect_finite(shade(scene, both, 16));
}

TEST(PathTracedStress, BlackEnvironmentAndBlackLeaves) {
    const Solution dark = shade(test::random_crown(50, 3, test::bright_leaf()), constant_environment(glm::vec3(0)), 0);
    expect_finite(dark);
    EXPECT_EQ(test::mean(dark), 0);
    EXPECT_EQ(*dark.estimated_error, 0);
    const Solution black = shade(test::random_crown(50, 3, Optics{}), test::sky_and_sun(), 8);
    expect_finite(black);
    EXPECT_EQ(test::mean(black), 0);
    EXPECT_GT(black.energy_absorbed, 0);
}

TEST(PathTracedStress, AlbedoOneInsideAClosedWhiteBox) {
    // Light gets in nowhere and is lost nowhere: roulette alone ends the paths.
    PatchScene scene;
    scene.optics = {{glm::vec3(1), glm::vec3(0)}};
    test::add_box(scene, glm::vec3(0), 1);
    Environment environment = test::sky_and_sun();
    environment.point_lights.push_back({"lamp", {0.1f, 0.2f, 0.3f}, glm::vec3(1)});
    expect_finite(shade(scene, environment, 64));
}

TEST(PathTracedStress, ImagesOfOnePixelAndOfSixteenThousand) {
    const PatchScene scene = test::random_crown(50, 3, test::realistic_leaf());
    expect_finite(shade(scene, constant_environment(glm::vec3(1)), 8));
    Environment wide;
    wide.remainder = Image(16384, 2, 3);
    for (std::size_t i = 0; i < wide.remainder.pixels.size(); ++i)
        wide.remainder.pixels[i] = i % 5000 == 0 ? 1000.f : 0.1f;
    expect_finite(shade(scene, wide, 8));
}

TEST(PathTracedStress, TwoHundredThousandLeaves) {
    const Solution solution = shade(test::random_crown(200000, 3.5f, test::realistic_leaf()), test::sky_and_sun(), 2);
    expect_finite(solution);
    EXPECT_GT(test::mean(solution), 0.05);
    EXPECT_NEAR((solution.energy_absorbed + solution.energy_escaped) / solution.energy_in, 1, 0.05);
}

} // namespace
} // namespace kokage

#include "common/services/parallel.h"
#include "foliage/first_light_by_rays.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

constexpr int kRays = 256;

/// A small leaf, front upwards.
PatchScene leaf_at(const glm::vec3& centre) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, centre - glm::vec3(5e-4f, 0, 5e-4f), {0, 0, 1e-3f}, {1e-3f, 0, 0});
    return scene;
}

FirstLight first_light(const PatchScene& scene, const Environment& environment, int rays = kRays) {
    const RayQueries queries(scene);
    return FirstLightByRays(queries, make_ground_cells(scene), rays, 1, silent_progress())
        .of(environment, silent_progress());
}

TEST(FirstLightByRays, OfAConstantSkyIsPiTimesIt) {
    const FirstLight light = first_light(leaf_at({0, 1, 0}), test::constant_environment({1, 2, 3}));
    EXPECT_LT(glm::distance(light.sky.front[0], kPi * glm::vec3(1, 2, 3)), 1e-4f);
    EXPECT_LT(glm::distance(light.sky.back[0], kPi * glm::vec3(1, 2, 3)), 1e-4f);
    EXPECT_EQ(light.open_front[0], 1);
    EXPECT_EQ(light.lights.front[0], glm::vec3(0));
}

/// A sky of 1 + y over an upward leaf: pi + 2pi/3 on its front, pi - 2pi/3 on its back.
TEST(FirstLightByRays, WeighsTheSkyByTheCosine) {
    Environment environment;
    environment.remainder = Image(64, 256, 3);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 64; ++x)
            environment.remainder.at(x, y)[0] = 1 + std::cos(kPi * (float(y) + 0.5f) / 256);
    const FirstLight light = first_light(leaf_at({0, 1, 0}), environment, 4096);
    EXPECT_NEAR(light.sky.front[0].r, kPi * 5 / 3, 0.01f);
    EXPECT_NEAR(light.sky.back[0].r, kPi / 3, 0.01f);
}

TEST(FirstLightByRays, OfTheSunIsIrradianceTimesCosineWhereItIsSeen) {
    PatchScene scene = leaf_at({0, 1, 0});
    Environment environment = test::constant_environment(glm::vec3(0));
    DistantLight sun;
    sun.direction = {0.6f, 0.8f, 0};
    sun.irradiance = {5, 4, 3};
    environment.distant_lights = {sun};
    FirstLight light = first_light(scene, environment);
    EXPECT_LT(glm::distance(light.lights.front[0], 0.8f * sun.irradiance), 1e-3f);
    EXPECT_EQ(light.lights.back[0], glm::vec3(0));
    test::add_rectangle(scene, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}); // a roof
    light = first_light(scene, environment);
    EXPECT_EQ(light.lights.front[0], glm::vec3(0));
    EXPECT_GT(light.lights.back[1].r, 0) << "the roof's upper side is its back";
}

TEST(FirstLightByRays, OfALampFallsWithTheSquareOfItsDistance) {
    Environment environment = test::constant_environment(glm::vec3(0));
    environment.point_lights = {{"lamp", {0, -4, 3}, glm::vec3(50)}}; // 5 below and 3 beside a leaf at height 1
    const FirstLight light = first_light(leaf_at({0, 1, 0}), environment);
    EXPECT_NEAR(light.lights.back[0].g, 50.f / 34 * 5 / std::sqrt(34.f), 2e-3f);
    EXPECT_EQ(light.lights.front[0], glm::vec3(0));
}

TEST(FirstLightByRays, KnowsSkyGroundAndPatchesApart) {
    PatchScene scene = leaf_at({0, 1, 0});
    scene.ground = Ground{0, glm::vec3(0.5f)};
    test::add_rectangle(scene, {0, 2, -1000}, {1000, 0, 0}, {0, 0, 2000}); // hides the sky's half with x > 0, nearly
    const RayQueries queries(scene);
    const GroundCells grid = make_ground_cells(scene);
    FirstLightByRays rays(queries, grid, 1024, 1, silent_progress());
    const FirstLight light = rays.of(test::constant_environment(glm::vec3(1)), silent_progress());
    std::vector<float> front, back;
    rays.filled_shares(front, back);
    EXPECT_NEAR(light.open_front[0], 0.5f, 0.01f);
    EXPECT_NEAR(front[0], 0.5f, 0.01f);
    EXPECT_EQ(light.open_back[0], 0) << "below there is ground";
    EXPECT_EQ(back[0], 0);
    const SideIrradiance ground = rays.from_ground(std::vector<glm::vec3>(grid.size(), glm::vec3(2)));
    EXPECT_NEAR(ground.back[0].r, 2 * kPi, 1e-4f);
    EXPECT_EQ(ground.front[0].r, 0);
    EXPECT_LT(light.bent_normal[0].x, -0.2f) << "open towards -X";
}

TEST(FirstLightByRays, OfBarkFallsOnItsFrontAlone) {
    PatchScene scene = leaf_at({0, 1, 0});
    scene.patches[0].kind = PatchKind::bark;
    const FirstLight light = first_light(scene, test::sky_and_sun());
    EXPECT_GT(light.sky.front[0].r, 0);
    EXPECT_EQ(light.sky.back[0], glm::vec3(0));
    EXPECT_EQ(light.lights.back[0], glm::vec3(0));
}

TEST(FirstLightByRays, TracesOnlyLightsThatMoved) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    const RayQueries queries(small.scene);
    FirstLightByRays rays(queries, {}, 16, 1, silent_progress());
    Environment environment = test::sky_and_sun();
    const FirstLight before = rays.of(environment, silent_progress());
    const std::uint64_t traced = rays.rays_traced();
    environment.distant_lights[0].irradiance *= 2.f;
    const FirstLight brighter = rays.of(environment, silent_progress());
    EXPECT_EQ(rays.rays_traced(), traced);
    for (std::size_t p = 0; p < before.lights.front.size(); ++p)
        EXPECT_LT(glm::distance(brighter.lights.front[p], 2.f * before.lights.front[p]), 1e-5f);
    environment.distant_lights[0].direction = {0, 1, 0};
    rays.of(environment, silent_progress());
    EXPECT_GT(rays.rays_traced(), traced);
}

TEST(FirstLightByRays, DoesNotDependOnThreads) {
    const test::SmallTree small = test::ball_on_a_skeleton(900, 2, test::realistic_leaf());
    set_thread_count(1);
    const FirstLight one = first_light(small.scene, test::sky_and_sun(), 16);
    set_thread_count(2);
    const FirstLight two = first_light(small.scene, test::sky_and_sun(), 16);
    set_thread_count(0);
    EXPECT_EQ(one.sky.front, two.sky.front);
    EXPECT_EQ(one.lights.back, two.lights.back);
}

} // namespace
} // namespace kokage

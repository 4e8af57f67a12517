// First light by the ends of lines: known answers, and a slow twin that follows rays from every patch.
#include "foliage/first_light.h"

#include "common/services/parallel.h"
#include "foliage/cosine_direction.h"
#include "tests/unit/foliage/small_trees.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

constexpr int kDirectionCount = 256;

/// With what it was made from.
struct TracedLight {
    explicit TracedLight(const PatchScene& patches, int directions = kDirectionCount, std::uint64_t seed = 1)
        : scene(patches), grid(make_ground_cells(scene)),
          light(scene, grid, directions, seed, silent_progress(), report) {}
    FirstLight of(const Environment& environment) {
        report = {};
        return light.of(environment, 1e-3, silent_progress(), report);
    }
    std::uint64_t count_of(const std::string& name) const {
        for (const WorkReport::Count& count : report.counts)
            if (count.name == name)
                return count.value;
        return 0;
    }
    PatchScene scene;
    GroundCells grid;
    WorkReport report;
    FirstLightByBundles light;
};

/// A small leaf, front upwards.
PatchScene leaf_at(const glm::vec3& centre) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, centre - glm::vec3(5e-4f, 0, 5e-4f), {0, 0, 1e-3f}, {1e-3f, 0, 0});
    return scene;
}

TEST(FirstLight, OfAConstantSkyIsPiTimesIt) {
    const FirstLight light = TracedLight(leaf_at({0, 1, 0})).of(constant_environment({1, 2, 3}));
    EXPECT_LT(glm::distance(light.sky.front[0], kPi * glm::vec3(1, 2, 3)), 1e-4f);
    EXPECT_LT(glm::distance(light.sky.back[0], kPi * glm::vec3(1, 2, 3)), 1e-4f);
    EXPECT_NEAR(light.open_front[0], 1, 1e-6);
    EXPECT_EQ(light.lights.front[0], glm::vec3(0));
}

/// A sky of 1 + y over an upward leaf: pi + 2pi/3 on its front, pi - 2pi/3 on its back. Of a lone leaf of a few pixels
/// the lines near the horizon count a little too little: they miss it more often than end_gather.h takes them to.
TEST(FirstLight, WeighsTheSkyByTheCosine) {
    Environment environment;
    environment.remainder = Image(64, 256, 3);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 64; ++x)
            environment.remainder.at(x, y)[0] = 1 + std::cos(kPi * (float(y) + 0.5f) / 256);
    const FirstLight light = TracedLight(leaf_at({0, 1, 0}), 1024).of(environment);
    EXPECT_NEAR(light.sky.front[0].r, kPi * 5 / 3, 0.05f);
    EXPECT_NEAR(light.sky.back[0].r, kPi / 3, 0.05f);
}

TEST(FirstLight, OfTheSunIsIrradianceTimesCosineWhereItIsSeen) {
    PatchScene scene = leaf_at({0, 1, 0});
    Environment environment = constant_environment(glm::vec3(0));
    DistantLight sun;
    sun.direction = {0.6f, 0.8f, 0};
    sun.irradiance = {5, 4, 3};
    environment.distant_lights = {sun};
    FirstLight light = TracedLight(scene).of(environment);
    EXPECT_LT(glm::distance(light.lights.front[0], 0.8f * sun.irradiance), 1e-3f);
    EXPECT_EQ(light.lights.back[0], glm::vec3(0));
    test::add_rectangle(scene, {-1, 2, -1}, {2, 0, 0}, {0, 0, 2}); // a roof, beside which the leaf is tiny
    light = TracedLight(scene).of(environment);
    EXPECT_EQ(light.lights.front[0], glm::vec3(0));
    EXPECT_GT(light.lights.back[1].r, 0) << "the roof's upper side is its back";
}

TEST(FirstLight, OfALampFallsWithTheSquareOfItsDistance) {
    Environment environment = constant_environment(glm::vec3(0));
    environment.point_lights = {{"lamp", {0, -4, 3}, glm::vec3(50)}}; // 5 below and 3 beside a leaf at height 1
    const FirstLight light = TracedLight(leaf_at({0, 1, 0})).of(environment);
    EXPECT_NEAR(light.lights.back[0].g, 50.f / 34 * 5 / std::sqrt(34.f), 2e-3f);
    EXPECT_EQ(light.lights.front[0], glm::vec3(0));
}

/// By lines to the roof, which is as large as the mean, and by rays of the leaf, which is tiny.
TEST(FirstLight, KnowsSkyGroundAndPatchesApart) {
    PatchScene scene = leaf_at({0, 1, 0});
    scene.ground = Ground{0, glm::vec3(0.5f)};
    test::add_rectangle(scene, {0, 2, -1000}, {1000, 0, 0}, {0, 0, 2000}); // hides the sky's half with x > 0, nearly
    TracedLight traced(scene, 1024);
    ASSERT_EQ(traced.light.bent_normals().size(), 2u);
    const FirstLight light = traced.of(constant_environment(glm::vec3(1)));
    std::vector<float> front, back;
    traced.light.filled_shares(front, back);
    EXPECT_NEAR(light.open_front[0], 0.5f, 0.03f);
    EXPECT_NEAR(front[0], 0.5f, 0.03f);
    EXPECT_EQ(light.open_back[0], 0) << "below there is ground";
    EXPECT_EQ(back[0], 0);
    EXPECT_NEAR(light.open_back[1], 1, 1e-3) << "the roof's upper side is its back";
    EXPECT_NEAR(light.open_front[1], 0, 1e-6) << "below there is ground";
    EXPECT_NEAR(light.sky.front[1].r, 0, 1e-6);
    const SideIrradiance ground = traced.light.from_ground(std::vector<glm::vec3>(traced.grid.size(), glm::vec3(2)));
    for (const float below : {ground.back[0].r, ground.front[1].r})
        EXPECT_NEAR(below, 2 * kPi, 1e-2f);
    EXPECT_EQ(ground.front[0].r, 0);
    EXPECT_EQ(ground.back[1].r, 0);
    EXPECT_LT(traced.light.bent_normals()[0].x, -0.2f) << "open towards -X";
    EXPECT_GT(traced.light.bent_normals()[1].y, 0.95f) << "the ground is not open";
}

TEST(FirstLight, OfBarkFallsOnItsFrontAlone) {
    PatchScene scene = leaf_at({0, 1, 0});
    scene.patches[0].kind = PatchKind::bark;
    scene.leaf_count = 0;
    TracedLight traced(scene);
    const FirstLight light = traced.of(test::sky_and_sun());
    EXPECT_GT(light.sky.front[0].r, 0);
    EXPECT_EQ(light.sky.back[0], glm::vec3(0));
    EXPECT_EQ(light.lights.back[0], glm::vec3(0));
    std::vector<float> front, back;
    traced.light.filled_shares(front, back);
    EXPECT_EQ(back[0], 1);
}

TEST(FirstLight, DrawsOnlyLightsThatMoved) {
    TracedLight traced(test::ball_on_a_skeleton(300, 2, test::realistic_leaf()).scene, 16);
    Environment environment = test::sky_and_sun();
    const FirstLight before = traced.of(environment);
    EXPECT_GT(traced.count_of("light rasters"), 0u);
    environment.distant_lights[0].irradiance *= 2.f;
    const FirstLight brighter = traced.of(environment);
    EXPECT_EQ(traced.count_of("light rasters"), 0u);
    for (std::size_t p = 0; p < before.lights.front.size(); ++p)
        EXPECT_LT(glm::distance(brighter.lights.front[p], 2.f * before.lights.front[p]), 1e-5f);
    environment.distant_lights[0].direction = {0, 1, 0};
    traced.of(environment);
    EXPECT_GT(traced.count_of("light rasters"), 0u);
}

TEST(FirstLight, DoesNotDependOnThreads) {
    PatchScene scene = test::ball_on_a_skeleton(900, 2, test::realistic_leaf()).scene;
    scene.ground = Ground{0, glm::vec3(0.5f)};
    const auto radiance = [](const GroundCells& grid) { return std::vector<glm::vec3>(grid.size(), glm::vec3(1)); };
    set_thread_count(1);
    TracedLight one(scene, 16);
    const FirstLight first = one.of(test::sky_and_sun());
    const SideIrradiance ground = one.light.from_ground(radiance(one.grid));
    set_thread_count(2);
    TracedLight two(scene, 16);
    const FirstLight second = two.of(test::sky_and_sun());
    EXPECT_EQ(ground.back, two.light.from_ground(radiance(two.grid)).back);
    set_thread_count(0);
    EXPECT_EQ(first.sky.front, second.sky.front);
    EXPECT_EQ(first.lights.back, second.lights.back);
}

/// The slow twin: one ray after another, each asked where it ends.
struct ByRays {
    SideIrradiance sky, lights, ground;
    std::vector<float> filled[2];
};

ByRays first_light_by_rays(const PatchScene& scene, const Environment& environment, const GroundCells& grid,
                           std::span<const glm::vec3> ground_radiance, int rays) {
    const RayQueries queries(scene);
    const PatchPoints points(scene);
    const std::vector<glm::vec3> dark(scene.patches.size(), glm::vec3(0.f));
    ByRays light{{dark, dark}, {dark, dark}, {dark, dark}, {}};
    constexpr float kFar = std::numeric_limits<float>::infinity();
    for (int side = 0; side < 2; ++side) {
        light.filled[side].assign(dark.size(), 0.f);
        const auto of = [side](SideIrradiance& both) -> std::vector<glm::vec3>& {
            return side == 0 ? both.front : both.back;
        };
        for (std::size_t p = 0; p < dark.size(); ++p)
            for (int i = 0; i < rays; ++i) {
                PathNumbers numbers(hash64(2 * p + std::size_t(side)), std::uint32_t(i));
                PatchPoint point;
                EXPECT_TRUE(points.sample(std::uint32_t(p), numbers, point));
                const glm::vec3 normal = side == 0 ? point.normal : -point.normal,
                                direction = cosine_direction(normal, numbers.pair());
                RayHit hit;
                if (!queries.first_hit(point.position, direction, queries.ray_offset(), kFar, hit))
                    of(light.sky)[p] += kPi / float(rays) * lat_long_radiance(environment.remainder, direction);
                else if (hit.ground)
                    of(light.ground)[p] +=
                        kPi / float(rays) * ground_radiance[grid.cell(point.position + hit.distance * direction)];
                else
                    light.filled[side][p] += 1 / float(rays);
                for (const DistantLight& sun : environment.distant_lights) {
                    const glm::vec2 pair = numbers.pair();
                    const glm::vec3 to_sun = sample_light(sun, pair.x, pair.y).direction;
                    if (!queries.occluded(point.position, to_sun, queries.ray_offset(), kFar))
                        of(light.lights)[p] += sun.irradiance * std::max(0.f, glm::dot(normal, to_sun)) / float(rays);
                }
            }
    }
    return light;
}

double difference(float a, float b) {
    return std::abs(double(a) - double(b));
}
double difference(const glm::vec3& a, const glm::vec3& b) {
    return std::abs(luminance(a) - luminance(b));
}

/// Mean difference of all sides over `scale`.
template <class T>
double mean_difference(const std::vector<T>& front, const std::vector<T>& back, const std::vector<T>& twin_front,
                       const std::vector<T>& twin_back, double scale) {
    double sum = 0;
    for (std::size_t p = 0; p < front.size(); ++p)
        sum += difference(front[p], twin_front[p]) + difference(back[p], twin_back[p]);
    return sum / (2 * double(front.size()) * scale);
}

/// A crown above ground, a fifth of its leaves too small for lines. Figures are mean differences as shares of full
/// light; stored, a third above what they are: the rays' own noise is most of it.
TEST(FirstLight, IsThatOfRaysFromEveryPatch) {
    PatchScene scene = test::ball_on_a_skeleton(200, 2, test::realistic_leaf()).scene;
    for (std::size_t p = 0; p < scene.patches.size(); p += 5) // leaves don't share corners here
        for (std::uint32_t k = 0; k < 6; ++k) {
            const glm::uvec3* triangles = &scene.triangles[scene.patches[p].first_triangle];
            const glm::vec3 fixed = scene.positions[triangles[0].x];
            glm::vec3& corner = scene.positions[triangles[k / 3][k % 3]];
            corner = fixed + (corner - fixed) / 6.f;
        }
    scene.ground = Ground{0.5f, glm::vec3(0.5f)};
    TracedLight traced(scene, 512);
    traced.light.count(traced.report);
    ASSERT_GT(traced.count_of("rays from small leaves"), 0u);
    std::vector<glm::vec3> ground_radiance;
    for (std::size_t cell = 0; cell + 1 < traced.grid.size(); ++cell) // brighter towards +X
        ground_radiance.emplace_back(1 + std::tanh(traced.grid.centre(cell).x));
    ground_radiance.emplace_back(1);
    const Environment environment = test::sky_and_sun();
    const ByRays rays = first_light_by_rays(scene, environment, traced.grid, ground_radiance, 512);
    const FirstLight light = traced.of(environment);
    const SideIrradiance ground = traced.light.from_ground(ground_radiance);
    std::vector<float> front, back;
    traced.light.filled_shares(front, back);
    EXPECT_LT(mean_difference(front, back, rays.filled[0], rays.filled[1], 1), 0.018);
    EXPECT_LT(mean_difference(light.sky.front, light.sky.back, rays.sky.front, rays.sky.back, kPiDouble), 0.007);
    EXPECT_LT(mean_difference(ground.front, ground.back, rays.ground.front, rays.ground.back, kPiDouble), 0.016);
    EXPECT_LT(mean_difference(light.lights.front, light.lights.back, rays.lights.front, rays.lights.back, 9), 0.003);
}

} // namespace
} // namespace kokage

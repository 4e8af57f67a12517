#include "picture_scenes.h"
#include "reflection/ground_look.h"
#include "reflection/ground_sky_light.h"
#include "reflection/sampling.h"

#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

using namespace test;

/// The slow twin: independent cosine-distributed rays from the point.
glm::vec3 brute_force(const ShadedScene& scene, const RayQueries& queries, const Backdrop& backdrop,
                      const glm::vec3& point) {
    glm::dvec3 sum(0.0);
    Random random(99);
    const int rays = 100000;
    for (int k = 0; k < rays; ++k) {
        const glm::vec3 direction = cosine_direction({random.uniform(), random.uniform()});
        RayHit hit;
        if (queries.first_hit(point, direction, queries.ray_offset(), std::numeric_limits<float>::infinity(), hit))
            sum += glm::dvec3(scene.radiance_front[scene.patches->triangle_patch[hit.triangle]]);
        else
            sum += glm::dvec3(backdrop.remainder(direction));
    }
    return glm::vec3(sum * (kPiDouble / rays));
}

Environment gradient_environment() {
    Environment environment;
    environment.remainder = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x) {
            const glm::vec3 d = direction_from_lat_long({(float(x) + 0.5f) / 64, (float(y) + 0.5f) / 32});
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = 1 + 0.5f * d[std::size_t(c)];
        }
    return environment;
}

TEST(GroundSkyLight, AgreesWithBruteForceUnderACrown) {
    const PatchScene patches = random_crown(3000, 4, Optics{});
    const ShadedScene scene = evenly_shaded(patches, {0.05f, 0.2f, 0.02f});
    const RayQueries queries(patches);
    const Environment environment = gradient_environment();
    const Backdrop backdrop(environment);
    const GroundSkyLight light(scene, queries, backdrop, 0.f, silent_progress());
    for (const glm::vec2& place : {glm::vec2(0, 0), glm::vec2(0.3f, -0.2f), glm::vec2(1, 1), glm::vec2(-2, 0.5f),
                                   glm::vec2(4, -3), glm::vec2(9, 9)}) {
        const glm::vec3 truth = brute_force(scene, queries, backdrop, {place.x, 0, place.y}),
                        found = light.irradiance(place.x, place.y);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(found[c], truth[c], 0.02f * GroundSkyLight::open_irradiance(backdrop)[c])
                << "at " << place.x << ", " << place.y;
    }
}

TEST(GroundSkyLight, OpenSkyIsTheIntegralOfTheSky) {
    const PatchScene patches;
    const RayQueries queries(patches);
    const Environment environment = gradient_environment();
    const Backdrop backdrop(environment);
    const GroundSkyLight light(evenly_shaded(patches, glm::vec3(0.f)), queries, backdrop, 0.f, silent_progress());
    // Of 1 + y/2 over the upper hemisphere: π + π/3. Of 1 + x/2: π.
    EXPECT_NEAR(GroundSkyLight::open_irradiance(backdrop).g, kPi + kPi / 3, 0.005f);
    EXPECT_NEAR(GroundSkyLight::open_irradiance(backdrop).r, kPi, 0.005f);
    EXPECT_EQ(light.irradiance(3, 4), GroundSkyLight::open_irradiance(backdrop));
}

TEST(GroundSkyLight, HasNoStepsWhereGridsMeet) {
    const PatchScene patches = random_crown(2000, 4, Optics{});
    const RayQueries queries(patches);
    const Environment environment = constant_environment(glm::vec3(1.f));
    const Backdrop backdrop(environment);
    const GroundSkyLight light(evenly_shaded(patches, glm::vec3(0.f)), queries, backdrop, 0.f, silent_progress());
    float before = light.irradiance(0.1f, 0.05f).g;
    for (float x = 0.1f; x < 12; x += 0.01f) {
        const float now = light.irradiance(x, 0.5f * x).g;
        EXPECT_LT(std::abs(now - before), 0.04f) << "at " << x;
        before = now;
    }
    EXPECT_NEAR(before, kPi, 1e-4f);
}

TEST(GroundVariation, HasMeanOneAndKeepsItsBounds) {
    glm::dvec3 sum(0.0);
    Random random(1);
    for (int k = 0; k < 20000; ++k) {
        const glm::vec3 value =
            ground_variation({random.uniform(-500, 500), random.uniform(-500, 500)}, 2.f, 0.01f, 0.3f);
        for (std::size_t c = 0; c < 3; ++c) {
            ASSERT_GE(value[c], 0.7f);
            ASSERT_LE(value[c], 1.3f);
        }
        sum += glm::dvec3(value) / 20000.0;
    }
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c], 1, 0.005);
    EXPECT_EQ(ground_variation({3.1f, 2.7f}, 2.f, 5.f, 0.3f), glm::vec3(1.f)); // finer than a pixel sees
    EXPECT_EQ(ground_variation({1e30f, 2.7f}, 2.f, 0.01f, 0.3f), glm::vec3(1.f));
}

} // namespace
} // namespace kokage

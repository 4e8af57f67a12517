#include "picture_scenes.h"
#include "reflection/light_choice.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace test;

const Scattering kLeaf{{0, 1, 0}, {0.1f, 0.3f, 0.05f}, {0.05f, 0.2f, 0.02f}};

Environment many_lights(int count) {
    Environment environment = constant_environment(glm::vec3(0.f));
    Random random(5);
    for (int k = 0; k < count; ++k)
        environment.distant_lights.push_back(
            disc_light(random_direction(random), 0.f,
                       glm::vec3(random.uniform(0.f, 1.f), random.uniform(0.f, 1.f), random.uniform(0.f, 1.f))));
    environment.point_lights.push_back({"lamp", {1, 2, 3}, glm::vec3(2.f)});
    return environment;
}

/// The slow twin: every light in full.
glm::vec3 all_lights(const Environment& environment, const glm::vec3& point) {
    glm::dvec3 sum(0.0);
    for (const DistantLight& light : environment.distant_lights)
        sum += glm::dvec3(light.irradiance * kLeaf.towards(light.direction));
    for (const PointLight& lamp : environment.point_lights) {
        const glm::vec3 offset = lamp.position - point;
        sum += glm::dvec3(lamp.intensity * kLeaf.towards(glm::normalize(offset)) / glm::dot(offset, offset));
    }
    return glm::vec3(sum);
}

glm::dvec3 mean_of_choices(const Environment& environment, int light_samples, std::uint32_t pixels,
                           std::size_t& rays_traced) {
    const LightChoice choice(environment, light_samples);
    std::vector<ShadowRay> rays;
    std::vector<float> scratch;
    glm::dvec3 sum(0.0);
    rays_traced = 0;
    for (std::uint32_t p = 0; p < pixels; ++p)
        for (std::uint32_t s = 0; s < 16; ++s) {
            choice.rays_at({0, 0, 0}, kLeaf, {s, 16, std::uint32_t(hash64(p))}, rays, scratch);
            rays_traced += rays.size();
            for (const ShadowRay& ray : rays)
                sum += glm::dvec3(ray.radiance) / (16.0 * pixels);
        }
    return sum;
}

TEST(LightChoice, FewLightsAreAllTakenExactly) {
    for (const int distant : {1, 3, 5}) {
        const Environment environment = many_lights(distant);
        std::size_t rays = 0;
        const glm::dvec3 sum = mean_of_choices(environment, 1, 1, rays);
        EXPECT_EQ(rays, (std::size_t(distant) + 1) * 16);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c], double(all_lights(environment, glm::vec3(0.f))[c]), 1e-5);
    }
}

/// As a studio's lamp behind the backdrop.
TEST(LightChoice, AStrongLightThatIsHiddenLeavesTheOthersWithoutNoise) {
    Environment environment = many_lights(4);
    const glm::vec3 visible = all_lights(environment, glm::vec3(0.f)), hidden(0, 1, 0);
    environment.distant_lights.push_back(disc_light(hidden, 0.f, glm::vec3(100.f)));
    const LightChoice choice(environment, 1);
    std::vector<ShadowRay> rays;
    std::vector<float> scratch;
    for (std::uint32_t s = 0; s < 16; ++s) {
        choice.rays_at({0, 0, 0}, kLeaf, {s, 16, 5}, rays, scratch);
        glm::vec3 sum(0.f);
        for (const ShadowRay& ray : rays)
            if (ray.direction != hidden)
                sum += ray.radiance;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c] / visible[c], 1, 1e-5);
    }
}

TEST(LightChoice, WideLightsShareEightRaysOrTakeFourEach) {
    for (const auto& [lights, rays_of_each] : {std::pair(1, 4u), {2, 4u}, {3, 2u}, {4, 2u}, {5, 1u}, {6, 1u}}) {
        Environment environment = constant_environment(glm::vec3(0.f));
        for (int k = 0; k < lights; ++k)
            environment.distant_lights.push_back(disc_light({0.1f * float(k), 1, 0}, 0.2f, glm::vec3(1.f)));
        const LightChoice choice(environment, 1);
        std::vector<ShadowRay> rays;
        std::vector<float> scratch;
        choice.rays_at({0, 0, 0}, kLeaf, {}, rays, scratch);
        EXPECT_EQ(rays.size(), std::size_t(lights) * rays_of_each);
    }
}

TEST(LightChoice, ChoosingAFewOfManyHasTheRightMean) {
    const Environment environment = many_lights(64);
    std::size_t rays = 0;
    const glm::dvec3 sum = mean_of_choices(environment, 1, 4000, rays);
    EXPECT_LE(rays, 2u * 16 * 4000);
    const glm::vec3 truth = all_lights(environment, glm::vec3(0.f));
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(sum[c] / double(truth[c]), 1, 0.005);
}

TEST(LightChoice, AStrongLightAmongWeakOnesIsNeverMissed) {
    Environment environment = many_lights(30);
    environment.distant_lights[11] = disc_light({0, 1, 0}, 0.f, glm::vec3(1e4f));
    const LightChoice choice(environment, 1);
    std::vector<ShadowRay> rays;
    std::vector<float> scratch;
    for (std::uint32_t p = 0; p < 500; ++p) {
        choice.rays_at({0, 0, 0}, kLeaf, {p % 16, 16, std::uint32_t(hash64(p))}, rays, scratch);
        glm::vec3 sum(0.f);
        for (const ShadowRay& ray : rays)
            sum += ray.radiance;
        EXPECT_NEAR(sum.g / (1e4f * 0.3f / kPi), 1, 0.01);
    }
}

TEST(LightChoice, NoLightAndNoScatteringGiveNoRays) {
    std::vector<ShadowRay> rays(3);
    std::vector<float> scratch;
    const Environment dark = constant_environment(glm::vec3(0.f));
    LightChoice(dark, 1).rays_at({0, 0, 0}, kLeaf, {}, rays, scratch);
    EXPECT_TRUE(rays.empty());
    const Environment lit = many_lights(9);
    LightChoice(lit, 1).rays_at({0, 0, 0}, {{0, 1, 0}, glm::vec3(0.f), glm::vec3(0.f)}, {}, rays, scratch);
    EXPECT_TRUE(rays.empty());
}

} // namespace
} // namespace kokage

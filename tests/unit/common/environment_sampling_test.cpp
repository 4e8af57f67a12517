// Choosing directions of the remainder and lights: densities against histograms, estimates against plain sums.
#include "common/services/error.h"
#include "common/trace/light_sampler.h"
#include "common/trace/remainder_sampler.h"
#include "tests/unit/common/scene_builders.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

Image spotted_sky(int width, int height) {
    Image image(width, height, 3);
    Random random(4);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = random.uniform() < 0.05f ? 10.f : 0.1f * random.uniform();
    return image;
}

TEST(RemainderSampler, DensityIntegratesToOne) {
    for (const int width : {1, 7, 64}) {
        const Image image = spotted_sky(width, std::max(1, width / 2));
        const RemainderSampler sampler(image);
        double integral = 0;
        for (int y = 0; y < 400; ++y)
            for (int x = 0; x < 800; ++x)
                integral += double(sampler.density(
                                direction_from_lat_long({(float(x) + 0.5f) / 800, (float(y) + 0.5f) / 400}))) *
                            pixel_solid_angle(y, 800, 400);
        EXPECT_NEAR(integral, 1, 0.02) << width;
    }
}

TEST(RemainderSampler, DrawsFollowTheDensity) {
    const Image image = spotted_sky(16, 8);
    const RemainderSampler sampler(image);
    std::vector<int> counts(16 * 8, 0);
    const int draws = 400000;
    Random random(1);
    for (int i = 0; i < draws; ++i) {
        const float a = random.uniform(), b = random.uniform();
        const auto sample = sampler.sample({a, b}, random.uniform());
        EXPECT_NEAR(glm::length(sample.direction), 1, 1e-5);
        const glm::vec2 uv = lat_long_from_direction(sample.direction);
        ++counts[std::size_t(std::min(7, int(uv.y * 8)) * 16 + int(uv.x * 16))];
    }
    double chi2 = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 16; ++x) {
            const glm::vec3 middle = direction_from_lat_long({(float(x) + 0.5f) / 16, (float(y) + 0.5f) / 8});
            const double expected = draws * double(sampler.density(middle)) * pixel_solid_angle(y, 16, 8);
            chi2 += std::pow(counts[std::size_t(y * 16 + x)] - expected, 2) / std::max(expected, 1.0);
        }
    EXPECT_LT(chi2, 200) << "127 degrees of freedom: 99.99 % lie below 192";
}

TEST(RemainderSampler, LargeImagesAreSampledByCells) {
    const Image image = spotted_sky(1100, 600); // not a multiple of the cells
    const RemainderSampler sampler(image);
    double exact = 0, estimate = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            exact += double(image.at(x, y)[1]) * pixel_solid_angle(y, image.width, image.height);
    Random random(1);
    const int draws = 200000;
    for (int i = 0; i < draws; ++i) {
        const float a = random.uniform(), b = random.uniform();
        const auto sample = sampler.sample({a, b}, random.uniform());
        EXPECT_GT(sample.density, 0);
        estimate += double(sampler.radiance(sample.direction).g / sample.density) / draws;
    }
    EXPECT_NEAR(estimate, exact, 0.02 * exact);
}

TEST(RemainderSampler, RefusesAnImageWithoutPixels) {
    const Image none, grey(4, 2, 1);
    EXPECT_THROW(RemainderSampler{none}, InputError);
    EXPECT_THROW(RemainderSampler{grey}, InputError);
}

TEST(RemainderSampler, ContrastOfConstantAndBlack) {
    const Environment constant = constant_environment(glm::vec3(3)), black = constant_environment(glm::vec3(0));
    EXPECT_NEAR(RemainderSampler(constant.remainder).contrast(), 1, 1e-9);
    const RemainderSampler dark(black.remainder);
    EXPECT_EQ(dark.contrast(), 1);
    EXPECT_NEAR(dark.density({0, 1, 0}), 1 / (4 * kPi), 1e-6);
    EXPECT_EQ(dark.radiance({0, 1, 0}), glm::vec3(0));
}

/// What the sampler estimates: front x irradiance on the normal's side + back x irradiance on the other side, no
/// shadows.
glm::dvec3 plain_sum(const Environment& environment, const glm::vec3& point, const glm::vec3& normal,
                     const glm::vec3& front, const glm::vec3& back) {
    glm::dvec3 sum(0);
    const auto add = [&](const glm::vec3& direction, const glm::dvec3& irradiance) {
        const double cosine = glm::dot(glm::dvec3(normal), glm::dvec3(direction));
        sum += std::abs(cosine) * irradiance * glm::dvec3(cosine > 0 ? front : back);
    };
    for (const DistantLight& light : environment.distant_lights)
        add(light.direction, glm::dvec3(light.irradiance));
    for (const PointLight& light : environment.point_lights) {
        const glm::dvec3 way(light.position - point);
        add(glm::vec3(glm::normalize(way)), glm::dvec3(light.intensity) / glm::dot(way, way));
    }
    return sum;
}

TEST(LightSampler, ManyLightsAddUpToTheirSum) {
    Environment environment = constant_environment(glm::vec3(0));
    Random random(2);
    for (int i = 0; i < 40; ++i) {
        DistantLight distant;
        distant.direction = test::random_direction(random);
        distant.irradiance =
            glm::vec3(random.uniform(), random.uniform(), random.uniform()) * std::pow(10.f, random.uniform(-2, 2));
        environment.distant_lights.push_back(distant);
        environment.point_lights.push_back(
            {"", 3.f * test::random_direction(random), glm::vec3(1, random.uniform(), 0)});
    }
    const LightSampler sampler(environment);
    const glm::vec3 point(0.3f, 0.1f, -0.2f), normal = test::random_direction(random);
    const glm::vec3 front(0.3f, 0.5f, 0.1f), back(0.2f, 0.1f, 0.4f);
    glm::dvec3 mean(0);
    const int draws = 200000;
    for (int i = 0; i < draws; ++i) {
        const float choice = random.uniform(), a = random.uniform();
        const auto ray = sampler.sample(point, normal, front, back, choice, {a, random.uniform()});
        ASSERT_TRUE(ray);
        const float cosine = glm::dot(normal, ray->direction);
        mean += glm::dvec3((cosine > 0 ? front : back) * ray->irradiance * std::abs(cosine)) / double(draws);
    }
    const glm::dvec3 expected = plain_sum(environment, point, normal, front, back);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[std::size_t(c)], expected[std::size_t(c)], 0.01 * expected[std::size_t(c)]);
}

TEST(LightSampler, RegionsDrawTheirTexelsAsSampleLightDoes) {
    Environment environment = constant_environment(glm::vec3(0));
    DistantLight region;
    region.direction = {0, 1, 0};
    region.half_angle = 0.5f;
    Random random(6);
    glm::dvec3 expected(0);
    for (int i = 0; i < 3000; ++i) {
        const glm::vec3 direction = glm::normalize(glm::vec3(0, 2, 0) + 0.9f * test::random_direction(random));
        const glm::vec3 irradiance(random.uniform(), i % 2 ? 0.f : 1.f, 0.1f);
        region.texels.push_back({direction, irradiance, 0.002f});
        region.irradiance += irradiance;
        expected += glm::dvec3(irradiance) * double(direction.y);
    }
    region.texels.push_back({{0, -1, 0}, glm::vec3(0), 0.002f}); // black: never drawn
    environment.distant_lights.push_back(region);
    const LightSampler sampler(environment);
    glm::dvec3 chosen(0), plain(0);
    const int draws = 20000;
    for (int i = 0; i < draws; ++i) {
        const glm::vec2 numbers(random.uniform(), random.uniform());
        const auto ray = sampler.sample({0, 0, 0}, {0, 1, 0}, glm::vec3(1), glm::vec3(1), 0.5f, numbers);
        ASSERT_TRUE(ray);
        ASSERT_GT(ray->direction.y, 0);
        chosen += glm::dvec3(ray->irradiance * ray->direction.y) / double(draws);
        const LightSample sample = sample_light(region, numbers.x, numbers.y);
        plain += glm::dvec3(sample.irradiance_over_pdf * sample.direction.y) / double(draws);
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(chosen[std::size_t(c)], expected[std::size_t(c)], 0.03 * expected[std::size_t(c)]);
        EXPECT_NEAR(chosen[std::size_t(c)], plain[std::size_t(c)], 0.002 * expected[std::size_t(c)]);
    }
}

TEST(LightSampler, LightsThatReachNothingCostNoRay) {
    Environment environment = constant_environment(glm::vec3(0));
    environment.distant_lights.resize(2);
    environment.distant_lights[0].direction = {0, 1, 0};
    environment.distant_lights[0].irradiance = glm::vec3(1);
    environment.distant_lights[1].direction = {0, -1, 0};
    environment.distant_lights[1].irradiance = glm::vec3(0); // black
    const LightSampler sampler(environment);
    EXPECT_TRUE(sampler.sample({0, 0, 0}, {0, 1, 0}, glm::vec3(1), glm::vec3(0), 0.999f, {0.5f, 0.5f}));
    EXPECT_FALSE(sampler.sample({0, 0, 0}, {0, -1, 0}, glm::vec3(1), glm::vec3(0), 0.f, {0.5f, 0.5f}));
    EXPECT_TRUE(sampler.sample({0, 0, 0}, {0, -1, 0}, glm::vec3(1), glm::vec3(1), 0.f, {0.5f, 0.5f}));
    EXPECT_TRUE(LightSampler(constant_environment(glm::vec3(1))).empty());
}

TEST(LightSampler, ExtremeLightsStayFinite) {
    Environment environment = constant_environment(glm::vec3(0));
    for (const float power : {1e-30f, 1e30f}) {
        DistantLight light;
        light.direction = {0, 1, 0};
        light.irradiance = glm::vec3(power);
        environment.distant_lights.push_back(light);
        environment.point_lights.push_back({"", {0, 1e-6f, 0}, glm::vec3(power)});
        environment.point_lights.push_back({"", {0, 0, 0}, glm::vec3(power)}); // at the point itself
        const auto ray =
            LightSampler(environment).sample({0, 0, 0}, {0, 1, 0}, glm::vec3(1), glm::vec3(0), 0.3f, {0.5f, 0.5f});
        ASSERT_TRUE(ray);
        EXPECT_TRUE(std::isfinite(glm::length(ray->direction)));
    }
}

} // namespace
} // namespace kokage

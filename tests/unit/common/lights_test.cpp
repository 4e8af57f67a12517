// Sampling of distant lights, and lights as a user writes them.
#include "common/environment/analytic_sky.h"
#include "common/environment/light_description.h"
#include "common/environment/light_radiance.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

DistantLight three_texels(float scale) {
    DistantLight light;
    light.direction = {0, 1, 0};
    light.texels = {{glm::normalize(glm::vec3(0.2f, 1, 0)), glm::vec3(1, 2, 3) * scale, 0.05f},
                    {glm::normalize(glm::vec3(-0.2f, 1, 0)), glm::vec3(0, 0, 0), 0.05f},
                    {glm::normalize(glm::vec3(0, 1, 0.3f)), glm::vec3(9, 1, 0) * scale, 0.1f}};
    for (const auto& texel : light.texels)
        light.irradiance += texel.irradiance;
    return light;
}

TEST(SampleLight, DiscIsUniformInSolidAngle) {
    for (const float half_angle : {0.f, 1e-4f, 0.00465f, 0.5f, 1.5707963f, 3.14159f}) {
        DistantLight light;
        light.direction = glm::normalize(glm::vec3(0.3f, 0.2f, -0.9f));
        light.half_angle = half_angle;
        light.irradiance = {1, 2, 3};
        Random random(1);
        constexpr int count = 100000;
        glm::dvec3 mean(0);
        double inner = 0, facing = 0;
        const float inner_cosine = 1 - 0.5f * (1 - std::cos(half_angle)); // cone of half the solid angle
        for (int i = 0; i < count; ++i) {
            const LightSample sample = sample_light(light, random.uniform(), random.uniform());
            const float cosine = glm::dot(sample.direction, light.direction);
            facing += double(sample.irradiance_over_pdf.g * std::max(0.f, cosine)) / count;
            ASSERT_NEAR(glm::length(sample.direction), 1, 1e-5);
            ASSERT_GE(cosine, std::cos(half_angle) - 2e-6f);
            inner += cosine > inner_cosine;
            mean += glm::dvec3(sample.direction) / double(count);
        }
        EXPECT_NEAR(facing, 2, 0.02) << "what a surface that faces the disc receives, half angle " << half_angle;
        // Mean direction of a cone: axis times (1 + cos)/2. Six standard deviations.
        const glm::dvec3 expected = 0.5 * (1 + std::cos(double(half_angle))) * glm::dvec3(light.direction);
        EXPECT_LT(glm::distance(mean, expected),
                  6 * std::max(1e-7, std::sin(std::min(1.5, double(half_angle)))) / std::sqrt(double(count)) + 2e-6);
        if (half_angle > 0.1f) {
            EXPECT_NEAR(inner / count, 0.5, 6 * 0.5 / std::sqrt(double(count)));
        }
    }
}

TEST(SampleLight, TexelsAreUnbiased) {
    for (const float scale : {1e-30f, 1.f, 1e30f}) {
        const DistantLight light = three_texels(scale);
        Random random(2);
        constexpr int count = 200000;
        glm::dvec3 sum(0), moment(0);
        for (int i = 0; i < count; ++i) {
            const LightSample sample = sample_light(light, random.uniform(), random.uniform());
            for (glm::length_t c = 0; c < 3; ++c) {
                ASSERT_TRUE(std::isfinite(sample.irradiance_over_pdf[c]));
            }
            sum += glm::dvec3(sample.irradiance_over_pdf) / double(count);
            moment += glm::dvec3(sample.irradiance_over_pdf) * double(sample.direction.z) / double(count);
        }
        glm::dvec3 expected_moment(0);
        for (const auto& texel : light.texels) // mean of a cone's directions
            expected_moment += glm::dvec3(texel.irradiance) * double(texel.direction.z) * 0.5 *
                               (1 + std::cos(double(texel.half_angle)));
        for (glm::length_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(sum[c] / double(light.irradiance[c]), 1, 0.02) << scale;
            EXPECT_NEAR(moment[c] / double(light.irradiance[c]), expected_moment[c] / double(light.irradiance[c]), 0.02)
                << scale;
        }
    }
}

TEST(SampleLight, EveryNumberGivesADirection) {
    DistantLight black = three_texels(0);
    for (const float u : {0.f, 0.25f, 0.999999f, 0x1.fffffep-1f}) {
        const LightSample sample = sample_light(black, u, u);
        EXPECT_NEAR(glm::length(sample.direction), 1, 1e-5);
        EXPECT_EQ(sample.irradiance_over_pdf, glm::vec3(0));
        const LightSample lit = sample_light(three_texels(1), u, u);
        EXPECT_GT(luminance(lit.irradiance_over_pdf), 0); // never the black texel
    }
}

TEST(RadianceAlong, GivesTheIrradianceBackAndNothingBesideTheLight) {
    DistantLight disc;
    disc.direction = glm::normalize(glm::vec3(0.3f, 0.2f, -0.9f));
    disc.half_angle = 0.3f;
    disc.irradiance = {1, 2, 3};
    DistantLight region = three_texels(1);
    region.half_angle = 0.5f;
    // A surface that faces the light gathers its irradiance: the sum of radiance x cosine over the sphere, about its
    // axis from 0 to 0.6.
    for (const DistantLight& light : {disc, region}) {
        const glm::vec3 across = glm::normalize(glm::cross(light.direction, glm::vec3(0.1f, 0.5f, 1))),
                        up = glm::cross(light.direction, across);
        glm::dvec3 sum(0.0);
        constexpr int kSteps = 1200;
        for (int i = 0; i < kSteps; ++i)
            for (int j = 0; j < kSteps; ++j) {
                const double polar = 0.6 * (i + 0.5) / kSteps, around = 2 * kPiDouble * (j + 0.5) / kSteps;
                const glm::vec3 direction =
                    float(std::cos(polar)) * light.direction +
                    float(std::sin(polar)) * (float(std::cos(around)) * across + float(std::sin(around)) * up);
                const bool is_disc = light.texels.empty();
                const double cosine = is_disc ? std::cos(polar) : 1;
                sum += cosine * std::sin(polar) * glm::dvec3(radiance_along(light, direction));
            }
        sum *= 0.6 / kSteps * 2 * kPiDouble / kSteps;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c], double(light.irradiance[c]), 0.01 * double(light.irradiance[c]) + 1e-3);
        EXPECT_EQ(radiance_along(light, -light.direction), glm::vec3(0.f));
    }
    disc.half_angle = 0;
    EXPECT_EQ(radiance_along(disc, disc.direction), glm::vec3(0.f));
}

TEST(LightDescription, ReadsAllKinds) {
    const auto sun = std::get<DistantLight>(parse_light("sun:90,30,3,2,1"));
    EXPECT_LT(glm::distance(sun.direction, glm::vec3(std::cos(kPi / 6), 0.5f, 0)), 1e-6f);
    EXPECT_EQ(sun.irradiance, glm::vec3(3, 2, 1));
    EXPECT_NEAR(sun.half_angle, 0.2666 * kPi / 180, 1e-7);
    EXPECT_TRUE(sun.texels.empty());

    const auto disc = std::get<DistantLight>(parse_light("disc:0,0,5,10"));
    EXPECT_LT(glm::distance(disc.direction, glm::vec3(0, 0, -1)), 1e-6f);
    EXPECT_EQ(disc.irradiance, glm::vec3(5));
    EXPECT_NEAR(disc.half_angle, 10 * kPi / 180, 1e-6);

    const auto directional = std::get<DistantLight>(parse_light("directional:-90,90,1e30"));
    EXPECT_LT(glm::distance(directional.direction, glm::vec3(0, 1, 0)), 1e-6f);
    EXPECT_EQ(directional.half_angle, 0);
    EXPECT_EQ(directional.irradiance, glm::vec3(1e30f));

    const auto point = std::get<PointLight>(parse_light("point:1,-2.5,3e0,0.5,0.25,0"));
    EXPECT_EQ(point.position, glm::vec3(1, -2.5f, 3));
    EXPECT_EQ(point.intensity, glm::vec3(0.5f, 0.25f, 0));

    Environment environment = constant_environment(glm::vec3(1));
    add_light(environment, "point:0,5,0,100");
    add_light(environment, "sun:135,40,9,8.5,7");
    EXPECT_EQ(environment.point_lights.size(), 1u);
    EXPECT_EQ(environment.distant_lights.size(), 1u);
}

TEST(LightDescription, RefusesWithTheReason) {
    auto expect_refused = [](const std::string& text, const std::string& reason) {
        try {
            parse_light(text);
            ADD_FAILURE() << "accepted " << text;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        }
    };
    expect_refused("lamp:1,2,3", "no kind 'lamp'");
    expect_refused("", "no kind ''");
    expect_refused("sun", "numbers are missing");
    expect_refused("sun:", "'' is not a number");
    expect_refused("sun:90,30", "2 numbers");
    expect_refused("sun:90,30,1,2", "4 numbers");
    expect_refused("sun:90,30,1,2,3,4", "6 numbers");
    expect_refused("sun:90,100,1", "elevation");
    expect_refused("sun:90,30,1,x,1", "'x' is not a number");
    expect_refused("sun:90,30,1,,1", "'' is not a number");
    expect_refused("sun:nan,30,1", "'nan' is not a number");
    expect_refused("sun:90,30,-1", "from 0");
    expect_refused("point:0,0,0,1e33", "from 0");
    expect_refused("disc:0,0,1,1,1,0", "half angle");
    expect_refused("disc:0,0,1,1,1,91", "half angle");
    expect_refused("point:1e13,0,0,1", "1e12");
}

} // namespace

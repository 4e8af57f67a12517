#include "common/environment/analytic_sky.h"
#include "common/environment/split_lights.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

double horizontal_illuminance(const Environment& sky) {
    const Image& image = sky.remainder;
    double sum = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const float* p = image.at(x, y);
            sum += double(luminance({p[0], p[1], p[2]})) * pixel_solid_angle(y, image.width, image.height) *
                   std::max(0.0, pixel_direction(x, y, image.width, image.height).y);
        }
    return sum;
}

TEST(AnalyticSky, AzimuthIsThatOfAMap) {
    EXPECT_LT(glm::distance(direction_from_azimuth_elevation(0, 0), glm::vec3(0, 0, -1)), 1e-6f);   // north
    EXPECT_LT(glm::distance(direction_from_azimuth_elevation(90, 0), glm::vec3(1, 0, 0)), 1e-6f);   // east
    EXPECT_LT(glm::distance(direction_from_azimuth_elevation(180, 0), glm::vec3(0, 0, 1)), 1e-6f);  // south
    EXPECT_LT(glm::distance(direction_from_azimuth_elevation(-90, 0), glm::vec3(-1, 0, 0)), 1e-6f); // west
    EXPECT_LT(glm::distance(direction_from_azimuth_elevation(1e6, 90), glm::vec3(0, 1, 0)), 1e-6f);
}

TEST(AnalyticSky, ZenithHasThePublishedLuminance) {
    // Worked by hand from appendix A.2 of Preetham et al. 1999: turbidity 3, sun at 45 degrees: 7.320 kcd/m^2, and
    // turbidity 2, sun at 20 degrees elevation: 1.9882 kcd/m^2 + ... see the formula (4.0453 T - 4.9710) tan chi -
    // 0.2155 T + 2.4192.
    EXPECT_NEAR(luminance(daylight_radiance({.sun_elevation_degrees = 45, .turbidity = 3}, {0, 1, 0})), 0.7320, 0.0005);
    const double chi = (4.0 / 9 - 2.0 / 120) * (2 * 20 * kPiDouble / 180);
    EXPECT_NEAR(luminance(daylight_radiance({.sun_elevation_degrees = 20, .turbidity = 2}, {0, 1, 0})),
                ((4.0453 * 2 - 4.9710) * std::tan(chi) - 0.2155 * 2 + 2.4192) / 10, 0.0005);
}

TEST(AnalyticSky, SunAndSkyHaveTheirUsualBrightness) {
    // 1 unit = 10,000 lux. Noon sun outside of the haze: 80 to 110 kilolux; a clear sky on flat ground 10 to 45.
    const Daylight noon{.sun_elevation_degrees = 60};
    const Environment sky = analytic_sky(noon);
    ASSERT_EQ(sky.distant_lights.size(), 1u);
    EXPECT_GT(luminance(sky.distant_lights[0].irradiance), 8);
    EXPECT_LT(luminance(sky.distant_lights[0].irradiance), 11);
    EXPECT_GT(horizontal_illuminance(sky), 1.0);
    EXPECT_LT(horizontal_illuminance(sky), 4.5);
    // A blue sky, a sun that reddens as it sets.
    const glm::vec3 zenith = daylight_radiance(noon, {0, 1, 0});
    EXPECT_GT(zenith.b, 1.5f * zenith.r);
    const glm::vec3 low = sun_irradiance({.sun_elevation_degrees = 5});
    EXPECT_GT(low.r, 2 * low.g);
    EXPECT_GT(low.g, 2 * low.b);
}

TEST(AnalyticSky, HasNoLowerHalfAndTheSunWhereItWasPut) {
    const Environment sky = analytic_sky({.sun_azimuth_degrees = 200, .sun_elevation_degrees = 30});
    EXPECT_FALSE(sky.has_lower_half);
    EXPECT_EQ(sky.remainder.width, 512);
    EXPECT_EQ(sky.remainder.height, 256);
    const glm::vec3 sun = direction_from_azimuth_elevation(200, 30);
    EXPECT_LT(glm::distance(sky.distant_lights[0].direction, sun), 1e-6f);
    EXPECT_NEAR(sky.distant_lights[0].half_angle, 0.2666 * kPi / 180, 1e-7);
    float brightest = 0;
    glm::vec3 where(0);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 512; ++x) {
            const float* p = sky.remainder.at(x, y);
            if (y >= 128) {
                ASSERT_EQ(p[0] + p[1] + p[2], 0.f);
            } else {
                ASSERT_GT(p[0] + p[1] + p[2], 0.f);
            }
            if (const float value = luminance({p[0], p[1], p[2]}); value > brightest) {
                brightest = value;
                where = glm::vec3(pixel_direction(x, y, 512, 256));
            }
        }
    EXPECT_GT(glm::dot(where, sun), std::cos(0.05f));
    EXPECT_EQ(daylight_radiance({}, {0, -1, 0}), glm::vec3(0));
}

TEST(AnalyticSky, IsSymmetricAboutTheSunsMeridian) {
    const Daylight daylight{.sun_azimuth_degrees = 70, .sun_elevation_degrees = 25};
    for (double away : {10.0, 60.0, 140.0})
        for (double elevation : {5.0, 40.0}) {
            const glm::vec3 left = daylight_radiance(daylight, direction_from_azimuth_elevation(70 - away, elevation));
            const glm::vec3 right = daylight_radiance(daylight, direction_from_azimuth_elevation(70 + away, elevation));
            EXPECT_LT(glm::distance(left, right), 1e-4f * glm::length(left));
        }
}

TEST(AnalyticSky, IsFiniteAndContinuousForEverySun) {
    for (const double turbidity : {1.7, 2.0, 3.0, 6.0, 10.0}) {
        double before = -1;
        for (double elevation = -90; elevation <= 90; elevation += elevation > -7 && elevation < 3 ? 0.05 : 1) {
            const Daylight daylight{.sun_elevation_degrees = elevation, .turbidity = turbidity, .width = 16};
            const Environment sky = analytic_sky(daylight);
            for (const float value : sky.remainder.pixels)
                ASSERT_TRUE(std::isfinite(value) && value >= 0) << turbidity << " " << elevation;
            const double sun = double(luminance(sun_irradiance(daylight)));
            ASSERT_TRUE(std::isfinite(sun) && sun >= 0);
            if (elevation < -0.27) {
                EXPECT_TRUE(sky.distant_lights.empty());
            }
            const double light = horizontal_illuminance(sky);
            if (before >= 0 && elevation > -5.99 && elevation < 3) {
                EXPECT_NEAR(light, before, 0.06 * before + 0.01 * (elevation > 0)) << turbidity << " " << elevation;
            }
            EXPECT_GT(light, 0);
            before = light;
        }
    }
}

TEST(AnalyticSky, HazeDimsTheSun) {
    double before = 1e9;
    for (const double turbidity : {1.7, 2.0, 4.0, 7.0, 10.0}) {
        const double sun = double(luminance(sun_irradiance({.turbidity = turbidity})));
        EXPECT_LT(sun, before);
        before = sun;
    }
    before = 0;
    for (double elevation = 0; elevation <= 90; elevation += 5) {
        const double sun = double(luminance(sun_irradiance({.sun_elevation_degrees = elevation})));
        EXPECT_GT(sun, before);
        before = sun;
    }
}

TEST(AnalyticSky, RefusesWhatTheModelCannot) {
    EXPECT_THROW(analytic_sky({.sun_elevation_degrees = 91}), InputError);
    EXPECT_THROW(analytic_sky({.sun_elevation_degrees = NAN}), InputError);
    EXPECT_THROW(analytic_sky({.sun_azimuth_degrees = INFINITY}), InputError);
    EXPECT_THROW(analytic_sky({.turbidity = 1}), InputError);
    EXPECT_THROW(analytic_sky({.turbidity = 20}), InputError);
    EXPECT_THROW(analytic_sky({.width = 1}), InputError);
}

TEST(PlainSkies, ConstantAndGradient) {
    const Environment constant = constant_environment({1, 2, 1e30f});
    EXPECT_TRUE(constant.has_lower_half);
    EXPECT_EQ(lat_long_radiance(constant.remainder, glm::normalize(glm::vec3(1, 2, 3))), glm::vec3(1, 2, 1e30f));
    EXPECT_NEAR(radiance_integral(constant.remainder).x, 4 * kPiDouble, 1e-12);

    const Environment gradient = gradient_environment({0, 0, 1}, {1, 1, 1}, {0.5f, 0, 0});
    EXPECT_LT(glm::distance(lat_long_radiance(gradient.remainder, {0, 1, 0}), glm::vec3(0, 0, 1)), 1e-4f);
    EXPECT_LT(glm::distance(lat_long_radiance(gradient.remainder, {0, -1, 0}), glm::vec3(0.5f, 0, 0)), 1e-4f);
    EXPECT_LT(glm::distance(lat_long_radiance(gradient.remainder, {1, 0, 0}), glm::vec3(1)), 1e-2f);
    EXPECT_LT(glm::distance(lat_long_radiance(gradient.remainder, glm::normalize(glm::vec3(1, 1, 0))),
                            glm::mix(glm::vec3(1), glm::vec3(0, 0, 1), std::sqrt(0.5f))),
              1e-3f);
    EXPECT_THROW(constant_environment(glm::vec3(-1, 0, 0)), InputError);
    EXPECT_THROW(constant_environment(glm::vec3(NAN, 0, 0)), InputError);
}

} // namespace

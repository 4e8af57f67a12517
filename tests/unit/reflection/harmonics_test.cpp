#include "reflection/maps/harmonics.h"

#include "common/directions/sphere_sets.h"
#include "common/directions/spherical_harmonics.h"
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// Noise in blocks, and a lamp of a few pixels.
Environment room(float lamp) {
    Environment environment;
    environment.remainder = Image(128, 64, 3);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            Random random(8, std::uint64_t(y / 8 * 16 + x / 8));
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = random.uniform(0.2f, 0.8f);
        }
    for (int c = 0; c < 3; ++c)
        environment.remainder.at(40, 20)[c] = environment.remainder.at(41, 20)[c] = lamp;
    return environment;
}

DistantLight sun(float half_angle) {
    DistantLight light;
    light.name = "sun";
    light.direction = glm::normalize(glm::vec3(1, 2, 3));
    light.half_angle = half_angle;
    light.irradiance = glm::vec3(3, 2, 1);
    return light;
}

/// Sum over pixels of radiance x solid angle x max(0, cosine), and of lights.
glm::dvec3 true_irradiance(const Environment& environment, const glm::dvec3& normal) {
    const Image& image = environment.remainder;
    glm::dvec3 sum(0.0);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double cosine = glm::dot(pixel_direction(x, y, image.width, image.height), normal);
            const float* p = image.at(x, y);
            sum +=
                std::max(cosine, 0.0) * pixel_solid_angle(y, image.width, image.height) * glm::dvec3(p[0], p[1], p[2]);
        }
    for (const DistantLight& light : environment.distant_lights)
        sum += std::max(glm::dot(glm::dvec3(light.direction), normal), 0.0) * glm::dvec3(light.irradiance);
    return sum;
}

double largest_irradiance_error(const Environment& environment, const HarmonicsSettings& settings) {
    const Harmonics harmonics = harmonics_of(environment, settings);
    double largest = 0;
    for (const glm::dvec3& normal : fibonacci_sphere(100).directions)
        largest = std::max(largest, glm::distance(glm::dvec3(harmonics.value(glm::vec3(normal))),
                                                  true_irradiance(environment, normal)));
    return largest;
}

TEST(Harmonics, OfIrradianceAreWhatASurfaceReceives) {
    Environment environment = room(0.5f);
    environment.distant_lights.push_back(sun(0));
    // A light from one direction needs many bands, and listed it needs none.
    HarmonicsSettings settings{.bands = 60, .quantity = HarmonicQuantity::irradiance};
    EXPECT_LT(largest_irradiance_error(environment, settings), 0.02);
    settings.list_lights = true;
    settings.bands = 12;
    EXPECT_LT(largest_irradiance_error(environment, settings), 0.01);
    settings.list_lights = false;
    EXPECT_GT(largest_irradiance_error(environment, settings), 0.02) << "the lone light's edge at the horizon";
}

TEST(Harmonics, OfAConstantSkyAreOneCoefficient) {
    Environment environment;
    environment.remainder = Image(4, 2, 3);
    std::fill(environment.remainder.pixels.begin(), environment.remainder.pixels.end(), 1.f);
    for (const auto& [quantity, expected] :
         {std::pair(HarmonicQuantity::radiance, 1.0), {HarmonicQuantity::irradiance, kPiDouble}}) {
        const Harmonics harmonics = harmonics_of(environment, {.quantity = quantity});
        ASSERT_EQ(harmonics.coefficients.size(), 9u);
        EXPECT_NEAR(double(harmonics.coefficients[0].x) * 0.28209479177387814, expected, 1e-6);
        for (std::size_t i = 1; i < 9; ++i)
            EXPECT_LT(glm::length(harmonics.coefficients[i]), 1e-6f);
    }
}

TEST(Harmonics, LightsAreInTheCoefficientsOrListedAndNeverBoth) {
    Environment environment = room(3000);
    environment.distant_lights.push_back(sun(0.01f));
    const Harmonics merged = harmonics_of(environment, {.bands = 7});
    const Harmonics apart = harmonics_of(environment, {.bands = 7, .list_lights = true});
    EXPECT_TRUE(merged.lights.empty());
    ASSERT_EQ(apart.lights.size(), 2u);
    EXPECT_EQ(apart.lights[1].name, "sun");
    EXPECT_GT(glm::dot(apart.lights[0].direction, glm::vec3(pixel_direction(40, 20, 128, 64))), 0.999f);
    // Together they are the same light.
    std::vector<glm::vec3> sum = apart.coefficients;
    std::vector<float> harmonics(49);
    for (const Harmonics::Light& light : apart.lights) {
        evaluate_sh(7, light.direction, harmonics);
        for (std::size_t i = 0; i < sum.size(); ++i)
            sum[i] += harmonics[i] * light.irradiance;
    }
    for (std::size_t i = 0; i < sum.size(); ++i)
        EXPECT_LT(glm::distance(sum[i], merged.coefficients[i]), 0.02f * glm::length(merged.coefficients[0])) << i;
    // The lamp's coefficients alone reach far below 0 on its other side; what remains does not.
    float least = 1e30f, least_apart = 1e30f;
    for (const glm::dvec3& d : fibonacci_sphere(500).directions) {
        least = std::min(least, merged.value(glm::vec3(d)).x);
        least_apart = std::min(least_apart, apart.value(glm::vec3(d)).x);
    }
    EXPECT_LT(least, -0.2f);
    EXPECT_GT(least_apart, 0.1f);
}

TEST(Harmonics, SameBitsWithAnyNumberOfThreadsAndBandsWithinReason) {
    const Environment environment = room(3000);
    set_thread_count(1);
    const Harmonics one = harmonics_of(environment, {.bands = 16, .list_lights = true});
    set_thread_count(3);
    const Harmonics three = harmonics_of(environment, {.bands = 16, .list_lights = true});
    set_thread_count(0);
    EXPECT_EQ(one.coefficients, three.coefficients);
    EXPECT_THROW(harmonics_of(environment, {.bands = 0}), InputError);
    EXPECT_THROW(harmonics_of(environment, {.bands = 513}), InputError);
    EXPECT_THROW(harmonic_quantity_from_name("light"), InputError);
}

} // namespace
} // namespace kokage

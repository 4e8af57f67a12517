// Spherical harmonics of 1 to 40 bands (and far more) on everything that could make them leave the finite.
#include "common/directions/lobes.h"
#include "common/directions/projection.h"
#include "common/directions/rotation.h"
#include "common/directions/sphere_sets.h"
#include "common/directions/window.h"
#include "common/directions/zonal.h"
#include "common/services/random.h"

#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

TEST(DirectionsStress, HarmonicsAreFiniteAndBoundedEverywhereTo1024Bands) {
    for (int bands : {1, 2, 40, 512, 1024}) {
        std::vector<double> values(sh_count(bands));
        std::vector<float> floats(sh_count(bands));
        for (const glm::dvec3& d : {glm::dvec3(0, 0, 1),
                                    {0, 0, -1},
                                    {1, 0, 0},
                                    {0, -1, 0},
                                    glm::normalize(glm::dvec3(1e-160, 0, 1)),
                                    glm::normalize(glm::dvec3(1e-8, 1e-8, -1)),
                                    glm::normalize(glm::dvec3(1, 1, 1e-300)),
                                    glm::normalize(glm::dvec3(0.3, 0.2, 1))}) {
            evaluate_sh(bands, d, values);
            for (int l = 0; l < bands; ++l) {
                double sum = 0;
                for (int m = -l; m <= l; ++m)
                    sum += values[sh_index(l, m)] * values[sh_index(l, m)];
                ASSERT_NEAR(sum * 4 * kPiDouble / (2 * l + 1), 1, 1e-8)
                    << bands << " l " << l; // addition theorem with itself
            }
            evaluate_sh(bands, glm::vec3(d), floats);
            for (const float value : floats)
                ASSERT_TRUE(std::isfinite(value));
        }
    }
}

TEST(DirectionsStress, EveryNumberOfBandsCarriesBlackConstantDimAndBrightImages) {
    for (int bands = 1; bands <= 40; ++bands)
        for (const float value : {0.f, 1e-30f, 1.f, 1e30f}) {
            Image image(32, 16, 3);
            std::fill(image.pixels.begin(), image.pixels.end(), value);
            std::vector<glm::vec3> c = project_lat_long(image, bands);
            ASSERT_NEAR(c[0].x, value * std::sqrt(4 * kPi), 1e-6f * value);
            for (std::size_t i = 1; i < c.size(); ++i)
                ASSERT_LE(glm::compMax(glm::abs(c[i])), 1e-6f * value);
            const auto window = window_factors(Window::non_negative, bands);
            convolve_zonal(std::span<glm::vec3>(c), std::span<const double>(window));
            ShRotation(glm::dmat3(glm::dvec3(0, 0, 1), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)), bands)
                .apply(std::span<glm::vec3>(c));
            ASSERT_NEAR(sh_radiance(c, glm::normalize(glm::vec3(1, 2, 3))).z, value, 1e-5f * value) << bands;
        }
}

TEST(DirectionsStress, ABrightPixelNeverMakesAWindowedFunctionNegative) {
    for (int bands = 1; bands <= 40; bands += 3) {
        Image image(64, 32, 3);
        std::fill(image.pixels.begin(), image.pixels.end(), 1e-3f);
        image.at(20, 9)[0] = 1e6f;
        std::vector<glm::vec3> c = project_lat_long(image, bands);
        const auto window = window_factors(Window::non_negative, bands);
        convolve_zonal(std::span<glm::vec3>(c), std::span<const double>(window));
        float largest = 0;
        for (const glm::dvec3& d : fibonacci_sphere(500).directions)
            largest = std::max(largest, sh_radiance(c, glm::vec3(d)).x);
        for (const glm::dvec3& d : fibonacci_sphere(500).directions)
            ASSERT_GE(sh_radiance(c, glm::vec3(d)).x, -1e-5f * largest) << bands; // what float sums leave
    }
}

TEST(DirectionsStress, OddShapedImages) {
    for (const auto& [width, height] : {std::pair(1, 1), {1, 500}, {16384, 1}, {16381, 2}, {2, 4096}, {3, 3}}) {
        Image image(width, height, 3);
        Random random(1);
        for (float& value : image.pixels)
            value = random.uniform();
        for (int bands : {1, 7, 40})
            for (const glm::vec3& c : project_lat_long(image, bands))
                ASSERT_TRUE(finite(c)) << width << " x " << height;
    }
}

TEST(DirectionsStress, LobesOfEveryExponent) {
    for (double exponent : {0.0, 1e-12, 0.3, 1.0, 39.0, 39.5, 5000.0, 1e5, 1e12, 1e300}) {
        for (const double value : phong_lobe(512, exponent)) {
            ASSERT_TRUE(std::isfinite(value)) << exponent;
            ASSERT_LE(std::abs(value), 1 + 1e-12) << exponent;
        }
        for (double squared : {0.0, 1e-20, 1.0, 2.0, 4.0})
            ASSERT_TRUE(std::isfinite(phong_lobe_value(exponent, squared))) << exponent << " " << squared;
    }
    for (double half_angle : {0.0, 1e-300, 1e-12, 1e-3, 3.1415926})
        for (const double value : cone_lobe(512, half_angle)) {
            ASSERT_TRUE(std::isfinite(value)) << half_angle;
            ASSERT_LE(std::abs(value), 1 + 1e-6) << half_angle;
        }
}

TEST(DirectionsStress, LargeSets) {
    EXPECT_EQ(geodesic_dome(72).directions.size(), 51842u); // [R] 6a
    EXPECT_EQ(stratified_sphere(1000000, 1).directions.size(), 1000000u);
    EXPECT_EQ(gauss_rings(400).directions.size(), 201u * 401u);
}

} // namespace

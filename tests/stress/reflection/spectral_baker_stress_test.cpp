// Where the spectral baker's numbers could go wrong: extreme images, sizes, lobes, tolerances.
#include "common/environment/split_lights.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/spectral_baker.h"
#include "reflection/maps/voxel_cube.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

TexelLayout scattered(LobeKind kind, double least, double most, std::size_t count) {
    TexelLayout layout;
    layout.kind = kind;
    Random random(1);
    for (std::size_t i = 0; i < count; ++i) {
        const double height = i == 0   ? 1
                              : i == 1 ? -1
                                       : 2 * random.uniform_double() - 1,
                     azimuth = 2 * kPiDouble * random.uniform_double(), sine = std::sqrt(1 - height * height);
        layout.directions.emplace_back(sine * std::cos(azimuth), height, sine * std::sin(azimuth));
        layout.parameters.push_back(float(least * std::pow(most / least, random.uniform_double())));
    }
    return layout;
}

std::vector<glm::vec3> baked(Baker& baker, std::size_t texels, const Environment& environment, WorkReport& report) {
    std::vector<glm::vec3> filtered(texels, glm::vec3(NAN));
    baker.bake(environment, filtered, report);
    return filtered;
}

/// Largest error over max(value, 1e-3 of the mean); a NaN is infinitely large.
double relative_error(const TexelLayout& layout, const Environment& environment,
                      const SpectralSettings& settings = {}) {
    const Image& image = environment.remainder;
    WorkReport report;
    const auto fast = spectral_baker(layout, image.width, image.height, settings, report);
    const auto slow = brute_force_baker(layout, image.width, image.height);
    const auto a = baked(*fast, layout.size(), environment, report),
               b = baked(*slow, layout.size(), environment, report);
    const double floor = 1e-3 * luminance_integral(image) / (4 * kPiDouble);
    double worst = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        for (glm::length_t c = 0; c < 3; ++c) {
            EXPECT_GE(a[i][c], 0);
            const double error = std::abs(double(a[i][c]) - double(b[i][c]));
            if (error > 0 || std::isnan(error))
                worst = error <= worst * std::max(double(b[i][c]), floor)
                            ? worst
                            : (std::isnan(error) ? INFINITY : error / std::max(double(b[i][c]), floor));
        }
    return worst;
}

Environment even_noise(int width, int height, std::uint64_t seed) {
    Environment environment;
    environment.remainder = Image(width, height, 3);
    Random random(seed);
    for (float& value : environment.remainder.pixels)
        value = random.uniform();
    return environment;
}

TEST(SpectralBakerStress, SunsAndLampsOfAnyStrengthAnywhere) {
    const TexelLayout phong = scattered(LobeKind::phong, 1, 3000, 2000), ggx = scattered(LobeKind::ggx, 0.01, 1, 300);
    for (const float strength : {1e2f, 1e4f, 1e6f, 1e10f, 1e20f, 1e30f})
        for (const int row : {0, 40, 127}) {
            Environment environment = even_noise(256, 128, 3);
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(200, row)[c] = strength;
            EXPECT_LT(relative_error(phong, environment), 3e-3) << strength << " in row " << row;
            if (row > 0) {
                EXPECT_LT(relative_error(ggx, environment), 3e-3) << strength << " in row " << row << " GGX";
            }
        }
}

TEST(SpectralBakerStress, OneBrightPixelOnBlack) {
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const TexelLayout layout =
            kind == LobeKind::phong ? scattered(kind, 1, 3000, 500) : scattered(kind, 0.01, 1, 500);
        for (const float strength : {1e-30f, 1.f, 1e30f}) {
            Environment environment;
            environment.remainder = Image(256, 128, 3);
            environment.remainder.at(17, 50)[1] = strength;
            EXPECT_LT(relative_error(layout, environment), 3e-3) << strength << " " << lobe_kind_name(kind);
        }
    }
}

TEST(SpectralBakerStress, OneColourIsItself) {
    Environment environment;
    environment.remainder = Image(64, 32, 3);
    for (const TexelLayout& layout :
         {scattered(LobeKind::phong, 1, 3000, 500), scattered(LobeKind::ggx, 0.005, 1, 500)})
        for (const float value : {0.f, 1e-30f, 0.3f, 1e30f}) {
            std::fill(environment.remainder.pixels.begin(), environment.remainder.pixels.end(), value);
            WorkReport report;
            const auto baker = spectral_baker(layout, 64, 32, {}, report);
            for (const glm::vec3& texel : baked(*baker, layout.size(), environment, report))
                EXPECT_EQ(texel, glm::vec3(value));
            // Nearly one colour takes all the steps.
            environment.remainder.at(5, 5)[0] *= 1.0001f;
            for (const glm::vec3& texel : baked(*baker, layout.size(), environment, report))
                EXPECT_NEAR(texel.g, value, 6e-4f * value);
        }
}

TEST(SpectralBakerStress, LobesFromHalfASphereToAHundredthOfAPixel) {
    const Environment environment = even_noise(128, 64, 6);
    EXPECT_LT(relative_error(scattered(LobeKind::phong, 0.05, 1e8, 1500), environment), 2e-3);
    EXPECT_LT(relative_error(scattered(LobeKind::ggx, 0.001, 1, 1500), environment), 2e-3);
}

TEST(SpectralBakerStress, NoTexelsAndOneTexel) {
    const Environment environment = even_noise(32, 16, 6);
    WorkReport report;
    EXPECT_TRUE(baked(*spectral_baker({}, 32, 16, {}, report), 0, environment, report).empty());
    EXPECT_LT(relative_error(scattered(LobeKind::phong, 5, 5, 1), environment), 2e-3);
}

TEST(SpectralBakerStress, ImageSixteenThousandPixelsWide) {
    const Environment environment = even_noise(16384, 8, 2);
    EXPECT_LT(relative_error(scattered(LobeKind::phong, 1, 50, 200), environment), 2e-3);
    Environment tall = even_noise(16384, 2048, 2);
    EXPECT_LT(relative_error(scattered(LobeKind::phong, 1, 200, 6), tall), 2e-3);
}

TEST(SpectralBakerStress, WholeCubeOnAnyNumberOfThreads) {
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const VoxelCube cube(kind, RoughnessScale::solved(32));
        Environment environment = even_noise(256, 128, 9);
        environment.remainder.at(40, 40)[2] = 1e5f;
        std::vector<std::vector<glm::vec3>> results;
        for (const int threads : {1, 2, 3}) {
            set_thread_count(threads);
            WorkReport report;
            const auto baker = spectral_baker(cube.layout(), 256, 128, {}, report);
            results.push_back(baked(*baker, cube.layout().size(), environment, report));
        }
        set_thread_count(0);
        EXPECT_EQ(results[0], results[1]);
        EXPECT_EQ(results[0], results[2]);
    }
}

} // namespace

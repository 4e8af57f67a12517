// Environments of odd sizes and extreme contents: finite, explained, and no longer than they should take.
#include "common/environment/analytic_sky.h"
#include "common/environment/load_environment.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

Image noise(int width, int height, float density, float brightness, std::uint64_t seed) {
    Image image(width, height, 3);
    Random random(seed);
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
        const float value = random.uniform() < density ? brightness * (1 + random.uniform()) : 0.1f * random.uniform();
        image.pixels[i] = image.pixels[i + 1] = image.pixels[i + 2] = value;
    }
    return image;
}

void expect_sound(const Environment& environment, const EnvironmentReport& report) {
    EXPECT_LE(environment.distant_lights.size(), 64u);
    EXPECT_TRUE(std::isfinite(report.energy_before) && std::isfinite(report.energy_after));
    EXPECT_LE(std::abs(report.energy_after - report.energy_before), 1e-5 * report.energy_before);
    for (const float value : environment.remainder.pixels)
        ASSERT_TRUE(std::isfinite(value) && value >= 0);
    for (const DistantLight& light : environment.distant_lights) {
        for (const float u : {0.f, 0.5f, 0.99999994f}) {
            const LightSample sample = sample_light(light, u, u);
            ASSERT_NEAR(glm::length(sample.direction), 1, 1e-5);
            ASSERT_TRUE(std::isfinite(glm::length(glm::dvec3(sample.irradiance_over_pdf))));
        }
    }
}

TEST(EnvironmentStress, SixteenThousandPixelsWideFromAFile) {
    const TemporaryFolder folder;
    {
        Image image = noise(16384, 512, 0, 0, 1);
        for (int x : {16382, 16383, 0, 1, 2}) // a lamp on the seam
            for (int y = 200; y < 203; ++y)
                std::fill_n(image.at(x, y), 3, 1e6f);
        save_image(folder / "wide.hdr", image);
    }
    for (int max_width : {0, 4096, 1000}) {
        EnvironmentReport report;
        const Environment environment = load_environment(folder / "wide.hdr", report, {.max_width = max_width});
        expect_sound(environment, report);
        ASSERT_EQ(environment.distant_lights.size(), 1u);
        EXPECT_EQ(environment.remainder.width, max_width == 0 ? 16384 : max_width);
        EXPECT_NE(report.note.find("16384 x 512"), std::string::npos) << report.note;
        EXPECT_LT(environment.distant_lights[0].direction.x, -0.9f); // u = 0 is -X
    }
}

TEST(EnvironmentStress, AHundredThousandSparks) {
    for (const float density : {0.0003f, 0.01f, 0.2f, 0.9f})
        for (const float brightness : {10.f, 1e4f}) {
            EnvironmentReport report;
            expect_sound(environment_from_image(noise(2048, 1024, density, brightness, 7), "sparks", report), report);
        }
}

TEST(EnvironmentStress, BrightPoles) {
    Image image = noise(512, 256, 0, 0, 3);
    for (int x = 0; x < 512; ++x)
        for (int y : {0, 1, 254, 255})
            std::fill_n(image.at(x, y), 3, 1e5f);
    EnvironmentReport report;
    const Environment environment = environment_from_image(image, "poles", report);
    expect_sound(environment, report);
    ASSERT_EQ(environment.distant_lights.size(), 2u);
    for (const DistantLight& light : environment.distant_lights)
        EXPECT_GT(std::abs(light.direction.y), 0.9999f);
}

TEST(EnvironmentStress, AllBadButOneAndWholeBlocksOfNan) {
    Image image(256, 128, 3);
    for (float& value : image.pixels)
        value = NAN;
    std::fill_n(image.at(17, 99), 3, 3.f);
    EnvironmentReport report;
    const Environment environment = environment_from_image(image, "nearly nothing", report);
    expect_sound(environment, report);
    for (const float value : environment.remainder.pixels)
        ASSERT_EQ(value, 3.f);
    EXPECT_EQ(report.nan_pixels, 256u * 128u - 1);
}

TEST(EnvironmentStress, ExtremeRadiance) {
    for (const float value : {1e-38f, 1e-30f, 1e30f, 9e31f, 1e38f}) {
        Image image = noise(64, 32, 0, 0, 5);
        std::fill_n(image.at(30, 10), 3, value);
        EnvironmentReport report;
        expect_sound(environment_from_image(image, "extreme", report), report);
        Image all(64, 32, 3);
        std::fill(all.pixels.begin(), all.pixels.end(), std::min(value, 1e32f));
        expect_sound(environment_from_image(all, "all extreme", report), report);
    }
}

TEST(EnvironmentStress, EverySplitSettingIsSafe) {
    const Image image = noise(128, 64, 0.02f, 100, 9);
    for (const LightSplitting& rule : {LightSplitting{.brightness_ratio = 0},
                                       {.brightness_ratio = 1e30},
                                       {.gap_degrees = 0},
                                       {.gap_degrees = 180},
                                       {.least_share = 0},
                                       {.least_share = 2},
                                       {.max_half_angle_degrees = 0},
                                       {.max_half_angle_degrees = 180},
                                       {.max_lights = 1},
                                       {.max_texels = 1},
                                       {.max_texels = 1000000}}) {
        EnvironmentReport report;
        expect_sound(environment_from_image(image, "settings", report, {.splitting = rule}), report);
    }
}

} // namespace

#include "common/environment/load_environment.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <limits>

namespace fs = std::filesystem;
using namespace kokage;

namespace {

constexpr float nan_value = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();

class LoadEnvironment : public ::testing::Test {
  protected:
    TemporaryFolder temporary;
    const fs::path folder = temporary.path();
};

Image smooth_image(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = 0.5f + 0.3f * std::sin(0.1f * float(x + 2 * y) + float(c));
    return image;
}

TEST_F(LoadEnvironment, DecodesPngFromSrgb) {
    const Image image = smooth_image(32, 16);
    save_image(folder / "a.png", image, {.png_bits = 16});
    EnvironmentReport report;
    const Environment environment = load_environment(folder / "a.png", report);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        ASSERT_NEAR(environment.remainder.pixels[i], image.pixels[i], 3e-5);
    EXPECT_EQ(report.note, "");
    EXPECT_NE(environment.description.find("a.png"), std::string::npos);
    EXPECT_TRUE(environment.has_lower_half);
}

TEST_F(LoadEnvironment, RepairsByTheStatedRuleAndCounts) {
    Image image = smooth_image(32, 16);
    const Image good = image;
    image.at(5, 3)[1] = nan_value;
    image.at(31, 7)[0] = infinite;
    image.at(0, 9)[2] = -0.5f;
    image.at(1, 9)[2] = -infinite;
    image.at(2, 9)[2] = 1e35f;
    Image repaired = image;
    EnvironmentReport report;
    repair_pixels(repaired, "test", false, report);
    EXPECT_EQ(report.nan_pixels, 1u);
    EXPECT_EQ(report.infinite_pixels, 2u);
    EXPECT_EQ(report.negative_pixels, 2u);
    EXPECT_EQ(report.first_bad_x, 5);
    EXPECT_EQ(report.first_bad_y, 3);
    float ring = 0, largest_red = 0;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            if (dx != 0 || dy != 0)
                ring += good.at(5 + dx, 3 + dy)[1] / 8;
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 32; ++x)
            if (x != 31 || y != 7)
                largest_red = std::max(largest_red, good.at(x, y)[0]);
    EXPECT_NEAR(repaired.at(5, 3)[1], ring, 1e-6f);
    EXPECT_EQ(repaired.at(31, 7)[0], largest_red);
    EXPECT_EQ(repaired.at(0, 9)[2], 0.f);
    EXPECT_EQ(repaired.at(1, 9)[2], 0.f);
    EXPECT_LE(repaired.at(2, 9)[2], 0.81f);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        if (image.pixels[i] >= 0 && image.pixels[i] < 1) {
            ASSERT_EQ(repaired.pixels[i], image.pixels[i]); // nothing else changes
        }
}

TEST_F(LoadEnvironment, StrictRefusesWithThePlace) {
    Image image = smooth_image(32, 16);
    image.at(7, 4)[2] = -1;
    image.at(9, 4)[2] = nan_value;
    EnvironmentReport report;
    try {
        environment_from_image(image, "some.exr", report, {.strict = true});
        FAIL() << "accepted";
    } catch (const InputError& error) {
        const std::string what = error.what();
        for (const char* part : {"some.exr", "(7, 4)", "channel 2", "2 such"})
            EXPECT_NE(what.find(part), std::string::npos) << what;
    }
    EXPECT_NO_THROW(environment_from_image(smooth_image(32, 16), "some.exr", report, {.strict = true}));
}

TEST_F(LoadEnvironment, TooLargeIsNotCalledInfinite) {
    Image image = smooth_image(32, 16);
    image.at(7, 4)[2] = 3e33f;
    EnvironmentReport report;
    environment_from_image(image, "some.exr", report);
    EXPECT_NE(report.note.find("0 NaN, 1 infinite or too large (above 1e32), 0 negative"), std::string::npos)
        << report.note;
    try {
        environment_from_image(image, "some.exr", report, {.strict = true});
        FAIL() << "accepted";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("is 3e+33 (too large, above 1e32)"), std::string::npos)
            << error.what();
    }
}

TEST_F(LoadEnvironment, RefusesAnImageWithoutAGoodPixel) {
    Image image(4, 2, 3);
    for (float& value : image.pixels)
        value = nan_value;
    EnvironmentReport report;
    EXPECT_THROW(environment_from_image(image, "bad", report), InputError);
    EXPECT_THROW(environment_from_image(Image(), "empty", report), InputError);
    EXPECT_THROW(load_environment(folder / "missing.hdr", report), InputError);
    image.at(3, 1)[0] = image.at(3, 1)[1] = image.at(3, 1)[2] = 2; // one good pixel is enough
    const Environment environment = environment_from_image(image, "hardly", report);
    for (const float value : environment.remainder.pixels)
        EXPECT_EQ(value, 2.f);
    EXPECT_EQ(report.nan_pixels, 7u);
}

TEST_F(LoadEnvironment, TinyImages) {
    for (const float value : {0.f, 1e-30f, 1.f, 1e30f}) {
        Image image(1, 1, 3);
        for (float& v : image.pixels)
            v = value;
        EnvironmentReport report;
        const Environment environment = environment_from_image(image, "pixel", report);
        EXPECT_EQ(environment.remainder.pixels, image.pixels);
        EXPECT_TRUE(environment.distant_lights.empty());
        EXPECT_TRUE(std::isfinite(report.energy_before));
        EXPECT_EQ(report.note, "");
    }
}

TEST_F(LoadEnvironment, SaysWhatIsOdd) {
    EnvironmentReport report;
    environment_from_image(smooth_image(30, 30), "square", report);
    EXPECT_NE(report.note.find("30 x 30"), std::string::npos);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("30 x 30"), std::string::npos);
    EXPECT_THROW(environment_from_image(smooth_image(30, 40), "cross", report), InputError);
    environment_from_image(smooth_image(1, 40), "column", report); // the same all around
    EXPECT_TRUE(report.warnings.empty());
    environment_from_image(smooth_image(64, 32), "wide", report, {.max_width = 16});
    EXPECT_NE(report.note.find("reduced from 64"), std::string::npos);
    EXPECT_TRUE(report.warnings.empty()) << "nothing is wrong with a large image";
}

TEST_F(LoadEnvironment, SplitsEveryRealEnvironmentSensibly) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA names no folder of real data";
    struct Expected {
        const char* name;
        std::size_t least, most; ///< lights
        double least_share, most_share;
    };
    // What a person sees in them: see the data's own notes. The shares are of all light.
    const Expected all[] = {{"overcast_potsdamer_platz.hdr", 0, 0, 0, 0}, // overcast
                            {"sky_clouds_sun.hdr", 1, 1, 0.4, 0.7},       // sun
                            {"sunset_venice.exr", 1, 1, 0.01, 0.05},      // setting sun
                            {"studio_small_03.hdr", 2, 2, 0.85, 1},       // two soft boxes on black
                            {"interior_hotel.exr", 3, 12, 0.3, 0.7},      // lamps, windows
                            {"esplanade.hdr", 5, 20, 0.5, 0.8},           // many lamps
                            {"night_dikhololo.hdr", 0, 3, 0, 0.1},        // stars, the glow of a town
                            {"forest_slope.hdr", 1, 20, 0.05, 0.5}};      // sky between trees: not hundreds
    for (const Expected& expected : all) {
        SCOPED_TRACE(expected.name);
        const fs::path path = fs::path(data) / "env" / expected.name;
        EnvironmentReport report;
        const Environment whole = load_environment(path, report, {.split = false});
        const Environment environment = load_environment(path, report);
        EXPECT_GE(environment.distant_lights.size(), expected.least);
        EXPECT_LE(environment.distant_lights.size(), expected.most);
        glm::dvec3 lights(0);
        for (const DistantLight& light : environment.distant_lights) {
            lights += glm::dvec3(light.irradiance);
            EXPECT_LE(light.half_angle, 32 * kPi / 180);
            EXPECT_LE(light.texels.size(), 64u);
        }
        const glm::dvec3 before = radiance_integral(whole.remainder),
                         after = radiance_integral(environment.remainder) + lights;
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(after[c] / before[c], 1, 1e-5);
        EXPECT_NEAR(report.energy_after / report.energy_before, 1, 1e-5);
        const double share = (lights.x + lights.y + lights.z) / (before.x + before.y + before.z);
        EXPECT_GE(share, expected.least_share);
        EXPECT_LE(share, expected.most_share);
        EXPECT_EQ(report.nan_pixels + report.infinite_pixels, 0u);
    }
}

} // namespace

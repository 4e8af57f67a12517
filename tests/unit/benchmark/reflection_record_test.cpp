#include "common/environment/split_lights.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_record.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

TEST(ReflectionRecord, WritesEveryFieldAndNullWhereThereIsNoFigure) {
    ReflectionRecord record;
    record.experiment = "table-2";
    record.size = 128;
    record.threshold = 0.01;
    record.max_error_255 = NAN;
    const nlohmann::json json = to_json(record);
    EXPECT_EQ(json["experiment"], "table-2");
    EXPECT_EQ(json["size"], 128);
    EXPECT_EQ(json["threshold"], 0.01);
    EXPECT_TRUE(json["max_error_255"].is_null());
    for (const char* field : {"environment", "method", "lobe", "setup_cpu_seconds", "cpu_seconds", "texels", "bytes",
                              "mean_error_255", "max_relative_error"})
        EXPECT_TRUE(json.contains(field)) << field;
}

TEST(ReflectionEnvironments, PatternIsHslOfLightnessOneHalf) {
    const Image pattern = colour_pattern();
    ASSERT_EQ(pattern.width, 512);
    ASSERT_EQ(pattern.height, 256);
    for (int y : {0, 100, 255})
        for (int x = 0; x < 512; ++x) {
            const float* p = pattern.at(x, y);
            const float most = std::max({p[0], p[1], p[2]}), least = std::min({p[0], p[1], p[2]});
            EXPECT_NEAR((most + least) / 2, 0.5f, 1e-6f);                      // HSL: lightness
            EXPECT_NEAR(most - least, float(y) / 255, 1e-6f) << x << "," << y; // HSL at lightness 0.5: saturation
        }
    // Red at the left, then yellow, green, cyan, blue, magenta.
    const float* yellow_green = pattern.at(128, 255); // a quarter round: 90 degrees of hue
    EXPECT_NEAR(yellow_green[0], 0.5f, 0.01f);
    EXPECT_NEAR(yellow_green[1], 1.f, 1e-6f);
    EXPECT_NEAR(yellow_green[2], 0.f, 1e-6f);
}

TEST(ReflectionEnvironments, PhotographIsTheHalvedClampedImage) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data || !*data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    const Image image = photograph(data), full = real_hdr(data, "overcast_potsdamer_platz.hdr", 0);
    ASSERT_EQ(image.width, 512);
    ASSERT_EQ(image.height, 256);
    for (float value : image.pixels)
        ASSERT_TRUE(value >= 0 && value <= 1);
    const float mean = (full.at(2, 201)[1] + full.at(3, 201)[1] + full.at(2, 200)[1] + full.at(3, 200)[1]) / 4;
    EXPECT_FLOAT_EQ(image.at(1, 100)[1], std::min(mean, 1.f));
}

TEST(ReflectionEnvironments, TheLoneSunIsAllButAllOfTheLight) {
    const Environment sun = unsplit(lone_sun(), "sun");
    EXPECT_EQ(std::count_if(sun.remainder.pixels.begin(), sun.remainder.pixels.end(), [](float v) { return v > 1; }),
              3);
    EXPECT_GT(luminance_integral(sun.remainder), 10 * 0.1 * 4 * kPiDouble);
}

} // namespace
} // namespace kokage

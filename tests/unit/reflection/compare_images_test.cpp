#include "common/services/error.h"
#include "common/services/random.h"
#include "common/types.h"
#include "reflection/compare_images.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(CompareImages, GivesTheFiguresOfAKnownDifference) {
    Image a(2, 1, 3), b(2, 1, 3);
    b.pixels = {1, 1, 1, 2, 2, 2};
    a.pixels = {1.5f, 1, 1, 2, 2, 1};
    const ImageComparison result = compare_images(a, b);
    EXPECT_NEAR(result.all.mean, 1.5 / 6, 1e-9);
    EXPECT_NEAR(result.all.rms, std::sqrt(1.25 / 6), 1e-9);
    EXPECT_NEAR(result.all.bias, -0.5 / 6, 1e-9);
    EXPECT_NEAR(result.all.relative.value(), (0.5 + 0.5) / 6, 1e-9);
    EXPECT_EQ(result.all.max, 1);
    EXPECT_EQ(result.max_x, 1);
    EXPECT_EQ(result.max_y, 0);
    EXPECT_EQ(result.channels, 3);
    EXPECT_NEAR(result.per_channel[0].mean, 0.25, 1e-9);
    EXPECT_EQ(result.per_channel[1].max, 0);
    EXPECT_NEAR(result.per_channel[2].bias, -0.5, 1e-9);
    EXPECT_NE(describe(result).find("max 1 at pixel (1, 0)"), std::string::npos);
}

TEST(CompareImages, NinetyFivePercentAreBelowP95) {
    Image a(100, 100, 1), b(100, 100, 1);
    Random random(3);
    for (float& value : a.pixels)
        value = random.uniform();
    const ImageComparison result = compare_images(a, b);
    EXPECT_NEAR(result.all.p95, 0.95, 0.01);
    EXPECT_NEAR(result.map_scale, 0.99, 0.01);
}

TEST(CompareImages, EqualPicturesHaveNoErrorAndABlackMap) {
    Image a(3, 3, 4);
    for (float& value : a.pixels)
        value = 7;
    const ImageComparison result = compare_images(a, a);
    EXPECT_EQ(result.all.max, 0);
    EXPECT_EQ(result.all.relative, 0);
    for (float value : result.map.pixels)
        EXPECT_LT(value, 0.01f);
}

TEST(CompareImages, MapGetsBrighterWithTheError) {
    Image a(11, 1, 1), b(11, 1, 1);
    for (int x = 0; x < 11; ++x)
        *a.at(x, 0) = float(x);
    const ImageComparison result = compare_images(a, b);
    EXPECT_EQ(result.map_scale, 10);
    const Image legend = error_legend(11, 1);
    double before = -1;
    for (int x = 0; x < 11; ++x) {
        const float* color = result.map.at(x, 0);
        const double light =
            0.2126 * std::pow(color[0], 2.2) + 0.7152 * std::pow(color[1], 2.2) + 0.0722 * std::pow(color[2], 2.2);
        EXPECT_GT(light, before);
        before = light;
        EXPECT_NEAR(color[0], legend.at(x, 0)[0], 1e-5f);
    }
}

TEST(CompareImages, ValuesThatAreNotFiniteAreCountedAndShown) {
    Image a(2, 1, 1), b(2, 1, 1);
    a.pixels = {std::nanf(""), 3};
    b.pixels = {1, 1};
    const ImageComparison result = compare_images(a, b);
    EXPECT_EQ(result.skipped_values, 1u);
    EXPECT_EQ(result.all.mean, 2);
    EXPECT_EQ(result.map.at(0, 0)[1], 1.f);
    EXPECT_EQ(result.map.at(0, 0)[0], 0.f);
}

TEST(CompareImages, RefusesDifferentShapesByName) {
    try {
        compare_images(Image(2, 3, 3), Image(3, 2, 3));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("2 x 3"), std::string::npos);
    }
    EXPECT_THROW(compare_images(Image(), Image()), InputError);
}

TEST(ErrorLegend, NamesTheErrorsOfItsColors) {
    EXPECT_EQ(error_legend_text(0.2, 100, " %"),
              "black 0, violet 5 %, red-purple 10 %, orange 15 %, pale yellow 20 % and above");
    EXPECT_EQ(error_legend_text(0, 1, ""), "all black: no difference");
    // The colours are what the words say.
    const Image legend = error_legend(5, 1);
    const auto color = [&](int quarter) {
        return glm::vec3(legend.at(quarter, 0)[0], legend.at(quarter, 0)[1], legend.at(quarter, 0)[2]);
    };
    EXPECT_LT(luminance(color(0)), 0.02f);
    EXPECT_TRUE(color(1).b > color(1).r && color(1).r > color(1).g) << "violet";
    EXPECT_TRUE(color(2).r > color(2).b && color(2).b > color(2).g) << "red-purple";
    EXPECT_TRUE(color(3).r > color(3).g && color(3).g > color(3).b && color(3).r > 0.9f) << "orange";
    EXPECT_TRUE(color(4).r > 0.9f && color(4).g > 0.9f && color(4).b > 0.5f) << "pale yellow";
}

} // namespace
} // namespace kokage

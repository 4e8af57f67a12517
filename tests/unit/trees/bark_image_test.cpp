// Bark textures: they tile, they keep to their ranges and means, and they tell the species apart.
#include "common/services/parallel.h"
#include "trees/growth.h"
#include "trees/growth/bark_image.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

constexpr std::size_t kind_count = 10;

/// Mean absolute step from texels to their right (or lower) neighbours, at one column (or row), across the border at
/// the last one.
double step_at(const Image& image, int at, bool across_columns) {
    double sum = 0;
    const int length = across_columns ? image.height : image.width,
              next = (at + 1) % (across_columns ? image.width : image.height);
    for (int i = 0; i < length; ++i)
        for (int c = 0; c < image.channels; ++c)
            sum += std::abs(double(across_columns ? image.at(at, i)[c] - image.at(next, i)[c]
                                                  : image.at(i, at)[c] - image.at(i, next)[c]));
    return sum / (length * image.channels);
}

/// True if the step across the border is no larger than the largest inside.
bool has_no_seam(const Image& image, bool columns) {
    double largest = 0;
    const int last = (columns ? image.width : image.height) - 1;
    for (int i = 0; i < last; ++i)
        largest = std::max(largest, step_at(image, i, columns));
    return step_at(image, last, columns) <= 1.05 * largest;
}

TEST(BarkImage, TilesWithoutASeam) {
    int seams_in_crops = 0;
    for (std::size_t k = 0; k < kind_count; ++k)
        for (const float age : {0.f, 0.5f, 1.f}) {
            const BarkImage bark = bark_image(BarkKind(k), age, 128);
            for (const bool columns : {false, true}) {
                EXPECT_TRUE(has_no_seam(bark.color, columns)) << bark_kind_names()[k] << ", age " << age;
                EXPECT_TRUE(has_no_seam(bark.height, columns)) << bark_kind_names()[k] << ", age " << age;
            }
            // The measure finds seams: three quarters of the tile are no tile.
            Image crop(96, 128, 1);
            for (int y = 0; y < 128; ++y)
                for (int x = 0; x < 96; ++x)
                    crop.at(x, y)[0] = bark.height.at(x, y)[0];
            seams_in_crops += !has_no_seam(crop, true);
        }
    EXPECT_GE(seams_in_crops, 18) << "of 30";
}

TEST(BarkImage, KeepsToItsRangesAndItsMeanColour) {
    for (std::size_t k = 0; k < kind_count; ++k)
        for (const float age : {0.f, 0.5f, 1.f}) {
            const BarkImage bark = bark_image(BarkKind(k), age, 96);
            ASSERT_EQ(bark.color.channels, 3);
            ASSERT_EQ(bark.height.channels, 1);
            EXPECT_EQ(bark.color.width, 96);
            EXPECT_EQ(bark.height.height, 96);
            glm::dvec3 mean(0.0);
            for (int i = 0; i < 96 * 96; ++i)
                for (int c = 0; c < 3; ++c) {
                    const float value = bark.color.pixels[std::size_t(3 * i + c)];
                    ASSERT_GE(value, 0.f);
                    ASSERT_LE(value, 1.f);
                    mean[c] += double(value) / (96 * 96);
                }
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(mean[c], mean_bark_color(BarkKind(k), age)[c], 0.015) << bark_kind_names()[k];
            const auto [low, high] = std::minmax_element(bark.height.pixels.begin(), bark.height.pixels.end());
            EXPECT_EQ(*low, 0.f);
            EXPECT_EQ(*high, 1.f);
            EXPECT_GT(bark.depth_m, 0.0005f);
            EXPECT_LT(bark.depth_m, 0.04f);
            EXPECT_GT(bark.roughness, 0.3f);
            EXPECT_LE(bark.roughness, 1.f);
        }
    EXPECT_THROW(bark_image(BarkKind::oak, 0, 0), std::invalid_argument);
    EXPECT_THROW(bark_image(BarkKind::oak, 1.5f, 8), std::invalid_argument);
    EXPECT_THROW(bark_image(BarkKind::oak, std::nanf(""), 8), std::invalid_argument);
}

double mean_difference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        sum += std::abs(double(a.pixels[i]) - double(b.pixels[i]));
    return sum / double(a.pixels.size());
}

/// Trunks wear seven ages, one above the other: no two of them may be far apart.
TEST(BarkImage, TurnsOldInEvenSteps) {
    for (const BarkKind kind : {BarkKind::birch, BarkKind::aspen, BarkKind::pine}) {
        const double whole = mean_difference(bark_image(kind, 0, 96).color, bark_image(kind, 1, 96).color);
        for (int step = 0; step < 6; ++step) {
            const BarkImage younger = bark_image(kind, float(step) / 6, 96),
                            older = bark_image(kind, float(step + 1) / 6, 96);
            EXPECT_LT(mean_difference(younger.color, older.color), 0.42 * whole)
                << bark_kind_names()[std::size_t(kind)] << ", step " << step;
        }
    }
}

TEST(BarkImage, IsTheSameWithAnyNumberOfThreads) {
    for (const BarkKind kind : {BarkKind::birch, BarkKind::pine}) {
        set_thread_count(1);
        const BarkImage one = bark_image(kind, 0.5f, 64);
        set_thread_count(4);
        const BarkImage four = bark_image(kind, 0.5f, 64);
        set_thread_count(0);
        EXPECT_EQ(one.color.pixels, four.color.pixels);
        EXPECT_EQ(one.height.pixels, four.height.pixels);
    }
}

TEST(BarkImage, SpeciesDiffer) {
    const auto color = [](BarkKind kind, float age) { return mean_bark_color(kind, age); };
    EXPECT_GT(luminance(color(BarkKind::birch, 0)), 2 * luminance(color(BarkKind::oak, 1))) << "white";
    EXPECT_LT(luminance(color(BarkKind::birch, 1)), 0.5f * luminance(color(BarkKind::birch, 0))) << "black at the foot";
    EXPECT_GT(color(BarkKind::pine, 0).r, 1.7f * color(BarkKind::pine, 0).g) << "orange above";
    EXPECT_LT(bark_image(BarkKind::beech, 1, 16).depth_m, 0.2f * bark_image(BarkKind::oak, 1, 16).depth_m) << "smooth";
    EXPECT_LT(bark_image(BarkKind::cherry, 0, 16).roughness, bark_image(BarkKind::oak, 0, 16).roughness) << "satin";
    // Lenticels of birch and cherry lie across: colours vary more along the stem than around it.
    for (const BarkKind kind : {BarkKind::birch, BarkKind::cherry}) {
        const BarkImage bark = bark_image(kind, 0, 128);
        double around = 0, along = 0;
        for (int i = 0; i < 127; ++i) {
            around += step_at(bark.color, i, true);
            along += step_at(bark.color, i, false);
        }
        EXPECT_GT(along, 1.5 * around) << bark_kind_names()[std::size_t(kind)];
    }
}

} // namespace
} // namespace kokage

#include "common/services/error.h"
#include "picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

using namespace test;

Image filled(int width, int height, const glm::vec3& color) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = color[std::size_t(c)];
    return image;
}

TEST(ToneMap, RisesWithRadianceFromBlackToWhite) {
    Image ramp(4000, 1, 3);
    for (int x = 0; x < ramp.width; ++x)
        for (int c = 0; c < 3; ++c)
            ramp.at(x, 0)[c] = x == 0 ? 0.f : std::exp2(float(x) / 100 - 20);
    const Image display = tone_map(ramp, 0.f);
    EXPECT_EQ(display.at(0, 0)[0], 0.f);
    EXPECT_GT(display.at(3999, 0)[0], 0.999f);
    for (int x = 1; x < ramp.width; ++x)
        for (int c = 0; c < 3; ++c) {
            ASSERT_GE(display.at(x, 0)[c], display.at(x - 1, 0)[c]) << x;
            ASSERT_LT(display.at(x, 0)[c] - display.at(x - 1, 0)[c], 0.02f) << "a step at " << x;
        }
}

TEST(ToneMap, AStopIsAFactorOfTwo) {
    const Image a = tone_map(filled(2, 2, {0.1f, 0.2f, 0.3f}), 1.f),
                b = tone_map(filled(2, 2, {0.2f, 0.4f, 0.6f}), 0.f);
    EXPECT_EQ(a.pixels, b.pixels);
}

TEST(ToneMap, AnyInputIsFinite) {
    const float inf = std::numeric_limits<float>::infinity(), nan = std::nanf("");
    Image image = filled(8, 1, glm::vec3(0.f));
    image.pixels = {nan, inf, -inf, -1, 0, 1e-40f, 3e38f, 1e-30f, 1, 0.5f, 0.1f, nan,
                    1,   2,   3,    4,  5, 6,      7,     8,      9, 10,   11,   12};
    for (const std::optional<float>& stops : {std::optional<float>(), std::optional<float>(0.f),
                                              std::optional<float>(-1000.f), std::optional<float>(1000.f)})
        for (float value : tone_map(image, stops).pixels)
            ASSERT_TRUE(value >= 0 && value <= 1);
    EXPECT_EQ(tone_map(image, 0.f).pixels[0], 0.f);
    EXPECT_GT(tone_map(image, 0.f).pixels[1], 0.999f);
    EXPECT_THROW(tone_map(image, nan), InputError);
    EXPECT_EQ(tone_map(Image(), {}).pixels.size(), 0u);
}

TEST(AutomaticExposure, BringsAnEvenPictureToAQuarterOfAStopAboveMiddleGreyAtAnyBrightness) {
    for (float radiance : {1e-25f, 1e-3f, 1.f, 1e6f, 1e25f})
        EXPECT_NEAR(automatic_exposure_stops(filled(9, 9, glm::vec3(radiance))), std::log2(0.216f / radiance), 1e-3f);
    EXPECT_EQ(automatic_exposure_stops(filled(9, 9, glm::vec3(0.f))), 0.f);
}

TEST(AutomaticExposure, IsNotMovedByASunInThePictureOrByBlackAroundIt) {
    Image image = filled(100, 100, glm::vec3(0.5f));
    const float usual = automatic_exposure_stops(image);
    for (int c = 0; c < 3; ++c)
        image.at(50, 50)[c] = 1e8f;
    EXPECT_NEAR(automatic_exposure_stops(image), usual, 0.01f);
    for (int y = 0; y < 100; ++y)
        for (int x = 0; x < 30; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = 0;
    EXPECT_NEAR(automatic_exposure_stops(image), usual, 0.01f);
}

TEST(AutomaticExposure, DoesNotBlowOutABrightFifth) {
    // A bright sky above a dark crown: the crown alone would ask for 2^7 more light.
    Image image = filled(100, 100, glm::vec3(0.01f));
    for (int y = 0; y < 35; ++y)
        for (int x = 0; x < 100; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = 1;
    EXPECT_LT(std::exp2(automatic_exposure_stops(image)), 3.f);
}

TEST(ToneMap, ASlenderSubjectIsNotLostAgainstTheSky) {
    Image picture = filled(40, 40, {0.5f, 0.6f, 0.8f}), subject(40, 40, 1);
    for (int y = 0; y < 40; ++y)
        for (int c = 0; c < 3; ++c) {
            picture.at(20, y)[c] = 0.05f;
            subject.at(20, y)[0] = 1.f;
        }
    const float of_all = automatic_exposure_stops(picture), of_tree = automatic_exposure_stops(picture, &subject);
    EXPECT_GT(of_tree, of_all + 0.3f);
    EXPECT_LT(of_tree, of_all + 3.f) << "the sky still counts";
    // What fills the picture anyway has no need of it.
    const Image everywhere = [] {
        Image mask(40, 40, 1);
        std::fill(mask.pixels.begin(), mask.pixels.end(), 1.f);
        return mask;
    }();
    EXPECT_EQ(automatic_exposure_stops(picture, &everywhere), of_all);
    const Image other_size(3, 3, 1);
    EXPECT_THROW(automatic_exposure_stops(picture, &other_size), InputError);
}

TEST(ToneMap, APaleSlenderSubjectDoesNotLeaveTheSkyDull) {
    const Image picture = filled(40, 40, glm::vec3(0.5f));
    Image subject(40, 40, 1);
    for (int y = 0; y < 40; ++y)
        subject.at(20, y)[0] = 1.f;
    const float metered = automatic_exposure_stops(picture), shown = automatic_exposure_stops(picture, &subject);
    EXPECT_NEAR(shown, 0.5f * (metered + std::log2(1.1f / 0.5f)), 1e-3f) << "half of the room below the highlight";
    EXPECT_LT(0.5f * std::exp2(shown), 1.1f);
}

} // namespace
} // namespace kokage

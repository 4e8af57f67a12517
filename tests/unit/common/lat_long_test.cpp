#include "common/environment/lat_long.h"
#include "common/environment/split_lights.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "tests/unit/common/random_image.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

using test::random_image;

TEST(LatLong, HasTheConventionOfThreeJs) {
    // three.js, equirectUv: u = atan(dir.z, dir.x) / 2pi + 0.5, v (from the bottom) = asin(dir.y) / pi + 0.5.
    auto expect_uv = [](glm::vec3 direction, float u, float v) {
        const glm::vec2 uv = lat_long_from_direction(direction);
        EXPECT_NEAR(uv.x, u, 1e-6f);
        EXPECT_NEAR(uv.y, v, 1e-6f);
    };
    expect_uv({1, 0, 0}, 0.5f, 0.5f);
    expect_uv({0, 0, 1}, 0.75f, 0.5f);
    expect_uv({0, 0, -1}, 0.25f, 0.5f);
    expect_uv(glm::normalize(glm::vec3(-1, 0, 1e-5f)), 1.f - 1e-5f / (2 * kPi), 0.5f);
    EXPECT_FLOAT_EQ(lat_long_from_direction({0, 1, 0}).y, 0.f); // the top row is up
    EXPECT_FLOAT_EQ(lat_long_from_direction({0, -1, 0}).y, 1.f);
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
        const glm::vec3 d =
            glm::normalize(glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
        const float u = std::atan2(d.z, d.x) / (2 * kPi) + 0.5f, v = 1 - (std::asin(d.y) / kPi + 0.5f);
        expect_uv(d, u, v);
        EXPECT_LT(glm::distance(direction_from_lat_long({u, v}), d), 2e-6f);
    }
}

TEST(LatLong, PixelDirectionsAreThoseOfTheirCentres) {
    for (int y = 0; y < 6; ++y)
        for (int x = 0; x < 12; ++x) {
            const glm::vec3 d = direction_from_lat_long({(float(x) + 0.5f) / 12, (float(y) + 0.5f) / 6});
            EXPECT_LT(glm::distance(glm::vec3(pixel_direction(x, y, 12, 6)), d), 1e-6f);
        }
}

TEST(LatLong, SolidAnglesSumToTheSphere) {
    for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {7, 5}, {1024, 512}, {16384, 8192}}) {
        double sum = 0;
        for (int y = 0; y < height; ++y)
            sum += width * pixel_solid_angle(y, width, height);
        EXPECT_NEAR(sum, 4 * kPiDouble, 1e-11) << width << " x " << height;
    }
}

TEST(LatLong, LookupInterpolatesAndWraps) {
    const Image image = random_image(8, 4, 2);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x) {
            const glm::vec3 value = lat_long_radiance(image, glm::vec3(pixel_direction(x, y, 8, 4)));
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(value[glm::length_t(c)], image.at(x, y)[c], 1e-5f);
        }
    // On the seam, half of the first and half of the last column.
    const glm::vec3 seam = lat_long_radiance(image, direction_from_lat_long({0.f, 0.375f}));
    EXPECT_NEAR(seam.x, 0.5f * (image.at(0, 1)[0] + image.at(7, 1)[0]), 1e-5f);
}

TEST(LatLong, ReducingKeepsTheIntegral) {
    for (const auto& [width, height, to] :
         {std::tuple(64, 32, 16), {64, 32, 1}, {50, 31, 17}, {97, 3, 8}, {16384, 4, 1024}}) {
        const Image image = random_image(width, height, 3), reduced = reduce_lat_long(image, to);
        EXPECT_EQ(reduced.width, to);
        const glm::dvec3 before = radiance_integral(image), after = radiance_integral(reduced);
        for (glm::length_t c = 0; c < 3; ++c)
            EXPECT_NEAR(after[c] / before[c], 1, 1e-6) << width << " to " << to;
    }
    const Image image = random_image(8, 4, 4);
    EXPECT_EQ(reduce_lat_long(image, 8).pixels, image.pixels);
    EXPECT_EQ(reduce_lat_long(image, 100).pixels, image.pixels);
}

TEST(LatLong, ReducingByWholeFactorsIsTheWeightedMeanOfBlocks) {
    const Image image = random_image(32, 16, 5), reduced = reduce_lat_long(image, 8);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 8; ++x) {
            double sum = 0, weights = 0;
            for (int j = 4 * y; j < 4 * y + 4; ++j)
                for (int i = 4 * x; i < 4 * x + 4; ++i) {
                    const double weight = pixel_solid_angle(j, 32, 16);
                    sum += weight * double(image.at(i, j)[1]);
                    weights += weight;
                }
            EXPECT_NEAR(reduced.at(x, y)[1], sum / weights, 1e-6);
        }
}

TEST(LatLong, ReducingGivesTheSameBitsWithAnyNumberOfThreads) {
    const Image image = random_image(512, 256, 6);
    set_thread_count(1);
    const Image one = reduce_lat_long(image, 100);
    set_thread_count(2);
    const Image two = reduce_lat_long(image, 100);
    set_thread_count(0);
    EXPECT_EQ(one.pixels, two.pixels);
}

TEST(LatLong, SquarePixelsHoldTheSameLight) {
    Image strip(4, 512, 3);
    for (std::size_t k = 0; k < strip.pixels.size(); ++k)
        strip.pixels[k] = float(k % 97);
    const Image divided = with_square_pixels(strip);
    EXPECT_EQ(divided.width, 1024);
    EXPECT_EQ(divided.height, 512);
    for (int x = 0; x < 1024; ++x)
        EXPECT_EQ(divided.at(x, 300)[1], strip.at(x / 256, 300)[1]);
    EXPECT_EQ(with_square_pixels(Image(1024, 512, 3)).width, 1024);
    EXPECT_EQ(with_square_pixels(Image(5, 5, 3)).width, 10);
    EXPECT_TRUE(with_square_pixels(Image()).empty());
}

} // namespace

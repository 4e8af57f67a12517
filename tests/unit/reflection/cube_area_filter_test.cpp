#include "common/directions/sphere_sets.h"
#include "common/services/parallel.h"
#include "reflection/maps/cube_area_filter.h"
#include "reflection/maps/prefiltered_cube.h"

#include <gtest/gtest.h>
#include <random>

namespace kokage {
namespace {

Image seeded_noise(int width, int height, unsigned seed) {
    Image image(width, height, 3);
    std::mt19937 random(seed);
    for (float& value : image.pixels)
        value = float(random() % 1000) / 999.f;
    return image;
}

/// The slow twin: a texel's mean by `count`² midpoints, each with its solid angle.
glm::dvec3 sampled(const Image& image, int face, int x, int y, int size, int count) {
    glm::dvec3 sum(0.);
    double weights = 0;
    for (int j = 0; j < count; ++j)
        for (int i = 0; i < count; ++i) {
            const glm::dvec3 d = cube_texel_direction(face, x * count + i, y * count + j, size * count);
            const double weight = std::pow(std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}), 3);
            const double u = 0.5 + std::atan2(d.z, d.x) / (2 * kPiDouble), v = std::acos(d.y) / kPiDouble;
            const float* pixel = image.at(std::min(int(u * image.width), image.width - 1),
                                          std::min(int(v * image.height), image.height - 1));
            sum += weight * glm::dvec3(double(pixel[0]), double(pixel[1]), double(pixel[2]));
            weights += weight;
        }
    return sum / weights;
}

struct Shape {
    int width, height, size;
};
class CubeAreaFilter : public testing::TestWithParam<Shape> {};

TEST_P(CubeAreaFilter, EveryTexelIsTheMeanOfWhatItCovers) {
    const auto [width, height, size] = GetParam();
    const Image image = seeded_noise(width, height, 7);
    const std::vector<glm::vec3> texels = cube_from_lat_long(image, size);
    for (int face = 0; face < 6; ++face)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const glm::vec3 texel = texels[cube_texel_index(face, x, y, size)];
                const glm::dvec3 wanted = sampled(image, face, x, y, size, 120);
                for (int c = 0; c < 3; ++c) // the samples are right to a pixel border's share of a texel
                    ASSERT_NEAR(texel[c], wanted[c], 6e-3) << "face " << face << ", texel " << x << ", " << y;
            }
}

TEST_P(CubeAreaFilter, TheIntegralOverTheSphereIsKept) {
    const auto [width, height, size] = GetParam();
    const Image image = seeded_noise(width, height, 8);
    const std::vector<glm::vec3> texels = cube_from_lat_long(image, size);
    double of_image = 0, of_cube = 0;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            of_image += pixel_solid_angle(y, width, height) * double(image.at(x, y)[1]);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const int in_face = int(i) % (size * size);
        of_cube += cube_texel_solid_angle(in_face % size, in_face / size, size) * double(texels[i].g);
    }
    EXPECT_NEAR(of_cube / of_image, 1, 1e-7);
}

INSTANTIATE_TEST_SUITE_P(Shapes, CubeAreaFilter,
                         testing::Values(Shape{16, 8, 8}, Shape{16, 8, 7}, Shape{18, 9, 8}, Shape{17, 5, 5},
                                         Shape{1, 1, 4}, Shape{64, 32, 2}, Shape{6, 3, 1}, Shape{256, 128, 4}),
                         [](const auto& shape) {
                             return std::to_string(shape.param.width) + "x" + std::to_string(shape.param.height) +
                                    "To" + std::to_string(shape.param.size);
                         });

TEST(CubeAreaFilterNumbers, ALonePixelIsNeitherMissedNorLeaksAndNothingIsNegative) {
    Image image(512, 256, 3);
    for (const auto& [x, y] : {std::pair{100, 3}, {0, 127}, {511, 255}, {256, 200}})
        for (int c = 0; c < 3; ++c)
            image.at(x, y)[c] = 1e30f;
    const std::vector<glm::vec3> texels = cube_from_lat_long(image, 64);
    double light = 0, wanted = 0;
    for (const int y : {3, 127, 255, 200})
        wanted += 1e30 * pixel_solid_angle(y, 512, 256);
    std::size_t lit = 0;
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const int in_face = int(i % (64 * 64));
        ASSERT_TRUE(texels[i].r >= 0 && std::isfinite(texels[i].r));
        light += double(texels[i].r) * cube_texel_solid_angle(in_face % 64, in_face / 64, 64);
        lit += texels[i].r > 1e20f;
    }
    EXPECT_NEAR(light / wanted, 1, 1e-6);
    EXPECT_LE(lit, 24u);
}

TEST(CubeAreaFilterNumbers, AConstantStaysConstant) {
    Image image(360, 180, 3);
    std::fill(image.pixels.begin(), image.pixels.end(), 0.3f);
    for (const glm::vec3& texel : cube_from_lat_long(image, 128))
        ASSERT_NEAR(texel.g, 0.3f, 1e-7);
}

TEST(CubeAreaFilterNumbers, TheSameBitsOnAnyThreadCount) {
    const Image image = seeded_noise(100, 50, 3);
    set_thread_count(1);
    const std::vector<glm::vec3> one = cube_from_lat_long(image, 48);
    set_thread_count(3);
    const std::vector<glm::vec3> three = cube_from_lat_long(image, 48);
    set_thread_count(0);
    EXPECT_EQ(one, three);
}

TEST(CubeLights, DiscsAndBareDirectionsKeepTheirLight) {
    DistantLight sun, lamp, point;
    sun.direction = glm::normalize(glm::vec3(1, 1, 0.2));
    sun.half_angle = 0.2f;
    sun.irradiance = glm::vec3(float(3 * kPiDouble * std::pow(std::sin(0.2), 2))); // radiance 3
    point.direction = {0, -1, 0};
    point.irradiance = glm::vec3(2.f);
    std::vector<glm::vec3> texels(6 * 64 * 64);
    add_lights_to_cube(texels, 64, {sun, point});
    const std::size_t down = cube_texel_towards({0, -1, 0}, 64);
    EXPECT_NEAR(double(texels[down].r) * cube_texel_solid_angle(32, 32, 64), 2, 1e-4);
    // Inside of the disc its radiance, outside nothing.
    for (const glm::dvec3& d : fibonacci_sphere(20000).directions) {
        const double angle = std::acos(glm::dot(d, glm::dvec3(sun.direction)));
        const float seen = texels[cube_texel_towards(d, 64)].r;
        if (angle < 0.15) {
            EXPECT_NEAR(seen, 3, 0.01);
        } else if (angle > 0.25 && cube_texel_towards(d, 64) != down) {
            EXPECT_EQ(seen, 0);
        }
    }
    double light = 0;
    for (std::size_t i = 0; i < texels.size(); ++i)
        light += double(texels[i].r) * cube_texel_solid_angle(int(i % 64), int(i / 64 % 64), 64);
    EXPECT_NEAR(light, 2 + 3 * 2 * kPiDouble * (1 - std::cos(0.2)), 1e-4);
    // A sun of its real size is smaller than a texel and lies in one, or where four meet, in four.
    lamp.direction = {0, 0, 1};
    lamp.half_angle = 0.004f;
    lamp.irradiance = glm::vec3(5.f);
    std::vector<glm::vec3> small(6 * 64 * 64);
    add_lights_to_cube(small, 64, {lamp});
    for (const auto& [x, y] : {std::pair{31, 31}, {32, 31}, {31, 32}, {32, 32}})
        EXPECT_NEAR(double(small[cube_texel_index(4, x, y, 64)].r) * cube_texel_solid_angle(x, y, 64), 1.25, 0.02);
}

} // namespace
} // namespace kokage

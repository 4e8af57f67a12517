#include "common/directions/spherical_harmonics.h"
#include "common/environment/lat_long.h"
#include "common/services/random.h"
#include "foliage/capture_directions.h"
#include "tests/unit/common/scene_builders.h"

#include <gtest/gtest.h>
#include <numeric>

namespace kokage {
namespace {

TEST(CaptureDirections, IntegrateProductsOfHarmonicsExactly) {
    constexpr int kBands = 7;
    const CaptureDirections set = make_capture_directions(kBands, 1);
    const std::size_t count = sh_count(kBands);
    std::vector<double> gram(count * count, 0.0), y(count);
    for (std::size_t k = 0; k < set.size(); ++k) {
        evaluate_sh(kBands, glm::dvec3(set.directions[k]), y);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t j = 0; j < count; ++j)
                gram[i * count + j] += double(set.solid_angles[k]) * y[i] * y[j];
    }
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = 0; j < count; ++j)
            EXPECT_NEAR(gram[i * count + j], i == j ? 1 : 0, 2e-6) << i << ' ' << j; // directions are floats
}

TEST(CaptureDirections, HaveAsManyAsAskedAndFillTheSphere) {
    for (int least : {1, 2, 3, 100, 968, 969, 5000}) {
        const CaptureDirections set = make_capture_directions(1, least);
        EXPECT_GE(set.size(), std::size_t(least));
        EXPECT_NEAR(std::accumulate(set.solid_angles.begin(), set.solid_angles.end(), 0.0), 4 * kPiDouble, 1e-4);
    }
}

TEST(CaptureDirections, EachLiesInItsOwnCell) {
    const CaptureDirections set = make_capture_directions(1, 1000);
    for (std::size_t k = 0; k < set.size(); ++k)
        EXPECT_EQ(set.cell(set.directions[k]), k);
}

TEST(CaptureDirections, CellsHaveTheirWeightAsSolidAngle) {
    const CaptureDirections set = make_capture_directions(1, 50);
    std::vector<double> hits(set.size(), 0.0);
    Random random(3);
    constexpr int kTries = 2'000'000;
    for (int i = 0; i < kTries; ++i)
        hits[set.cell(test::random_direction(random))] += 4 * kPiDouble / kTries;
    for (std::size_t k = 0; k < set.size(); ++k)
        EXPECT_NEAR(hits[k], set.solid_angles[k], 6 * std::sqrt(set.solid_angles[k] * 4 * kPiDouble / kTries)) << k;
}

TEST(CellMeans, KeepTheEnergyOfImagesOfAnySize) {
    const CaptureDirections set = make_capture_directions(1, 200);
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {20, 10}, {61, 17}, {512, 256}}) {
        Image image(width, height, 3);
        Random random(1);
        for (float& value : image.pixels)
            value = random.uniform();
        glm::dvec3 before{0.0}, after{0.0};
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; ++x)
                for (std::size_t c = 0; c < 3; ++c)
                    before[c] += double(image.at(x, y)[c]) * pixel_solid_angle(y, width, height);
        const std::vector<glm::vec3> means = cell_means(set, image);
        for (std::size_t k = 0; k < set.size(); ++k)
            after += glm::dvec3(means[k]) * double(set.solid_angles[k]);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(after[c] / before[c], 1, 1e-6) << width << 'x' << height;
    }
}

TEST(CellMeans, PutAPixelWhereItsDirectionIs) {
    const CaptureDirections set = make_capture_directions(1, 200);
    Image image(64, 32, 3);
    image.at(50, 9)[1] = 1;
    const std::vector<glm::vec3> means = cell_means(set, image);
    const std::size_t cell = set.cell(direction_from_lat_long({50.5f / 64, 9.5f / 32}));
    EXPECT_GT(means[cell].g, 0);
    for (std::size_t k = 0; k < set.size(); ++k) {
        EXPECT_LE(means[k].g, means[cell].g);
        EXPECT_EQ(means[k].r, 0);
    }
}

TEST(CellMeans, OfAConstantAreThatConstant) {
    const CaptureDirections set = make_capture_directions(1, 968);
    const Environment constant = constant_environment({0.25f, 1, 4});
    for (const glm::vec3& mean : cell_means(set, constant.remainder))
        EXPECT_LT(glm::distance(mean, glm::vec3(0.25f, 1, 4)), 1e-5f);
}

} // namespace
} // namespace kokage

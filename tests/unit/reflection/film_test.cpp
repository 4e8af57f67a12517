// Camera rays as pixels: the filter's weights, and more rays where they disagree.
#include "reflection/film.h"
#include "reflection/sample_plan.h"
#include "reflection/sampling.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

TEST(Film, PixelFilterIsTheDensityOfItsOffsets) {
    double integral = 0;
    constexpr int kSteps = 3000;
    for (int i = 0; i < kSteps; ++i)
        integral += double(pixel_filter(-1.5f + 3 * (float(i) + 0.5f) / kSteps)) * 3 / kSteps;
    EXPECT_NEAR(integral, 1, 1e-4);
    EXPECT_EQ(pixel_filter(1.5f), 0);
    EXPECT_EQ(pixel_filter(NAN), 0);
    for (const float u : {0.1f, 0.3f, 0.5f, 0.8f}) {
        const double density = 0.02 / double(pixel_filter_offset(u + 0.01f) - pixel_filter_offset(u - 0.01f));
        EXPECT_NEAR(double(pixel_filter(pixel_filter_offset(u))) / density, 1, 0.01) << u;
    }
}

/// Radiance by place in the picture; every square has as many rays as `count` says.
template <class Radiance, class Count>
Picture exposed(int width, int height, const Radiance& radiance, const Count& count) {
    const PictureOptions options = small_picture(width, height);
    const CameraFrame frame = camera_frame(camera_at({0, 0, 1}, {0, 0, 0}), width, height);
    Film film(options, frame);
    for (int band = 0; band < film.band_count(); ++band)
        for (int y = film.first_row(band); y < film.end_row(band); ++y)
            for (int x = -1; x <= width; ++x) {
                std::vector<CameraSample> samples;
                const int n = count(x, y);
                for (int j = 0; j < n; ++j)
                    for (int i = 0; i < n; ++i) {
                        CameraSample sample;
                        sample.place = (glm::vec2(i, j) + 0.5f) / float(n);
                        sample.seen = SeenByRay::surroundings(
                            glm::vec3(radiance(float(x) + sample.place.x, float(y) + sample.place.y)));
                        samples.push_back(sample);
                    }
                film.add(band, x, y, samples);
            }
    return film.picture();
}

TEST(Film, IsTheIntegralOfTheFilterAcrossBandsAndForAnyNumberOfRays) {
    // A wave: the filter's integral over it, pixel by pixel, by a sum over 60 x 60 places.
    const auto wave = [](float x, float y) { return 1 + std::sin(1.3f * x + 0.4f) * std::cos(0.9f * y); };
    constexpr int kWidth = 12, kHeight = 21; // two bands
    const Picture picture = exposed(kWidth, kHeight, wave, [](int x, int y) { return 4 + (x + 2 * y + 3) % 4; });
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            double truth = 0, weights = 0;
            for (int j = 0; j < 60; ++j)
                for (int i = 0; i < 60; ++i) {
                    const float dx = -1.5f + (float(i) + 0.5f) / 20, dy = -1.5f + (float(j) + 0.5f) / 20;
                    const double weight = double(pixel_filter(dx) * pixel_filter(dy));
                    truth += weight * double(wave(float(x) + 0.5f + dx, float(y) + 0.5f + dy));
                    weights += weight;
                }
            EXPECT_NEAR(double(picture.radiance.at(x, y)[0]), truth / weights, 4e-3) << x << " " << y;
        }
}

TEST(Film, HoldsWhatPicturesCanHold) {
    const Picture picture = exposed(
        3, 2, [](float x, float) { return x < 1 ? NAN : INFINITY; }, [](int, int) { return 3; });
    for (const float value : picture.radiance.pixels)
        EXPECT_TRUE(std::isfinite(value));
}

TEST(SamplePlan, SpendsTheAskedMeanWhereRaysDisagree) {
    std::vector<double> spreads;
    for (int k = 0; k < 1000; ++k)
        spreads.push_back(k < 600 ? 0 : 0.001 * k);
    const SamplePlan plan(spreads, 32, SamplePlan::first_samples(32));
    double sum = 0;
    for (const double spread : spreads)
        sum += plan.count(spread);
    EXPECT_NEAR(sum / 1000, 32, 0.5);
    EXPECT_EQ(plan.count(0), 8);
    EXPECT_NEAR(double(plan.count(0.9)) / plan.count(0.6), std::pow(1.5, 2. / 3), 0.03);
    EXPECT_EQ(plan.count(1e300), 8 * 32);
}

TEST(SamplePlan, StopsAtTheFirstRaysWhereNothingVariesAndGivesAllWhereFewAreAsked) {
    EXPECT_EQ(SamplePlan({0, 0, 0}, 64, 16).count(0), 16);
    EXPECT_EQ(SamplePlan({}, 3, SamplePlan::first_samples(3)).count(7), 3);
    EXPECT_EQ(SamplePlan({1, 1, 1}, 8, 4).count(1), 8);
}

} // namespace
} // namespace kokage::test

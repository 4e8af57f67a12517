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

/// An upright edge at x = 4.37: ground of radiance 1 to its left, surroundings of 3 + slope (x - edge) to its right.
struct Edge {
    static constexpr float kPlace = 4.37f;
    float slope = 0;

    CameraSample sample(int x, const glm::vec2& place) const {
        CameraSample sample;
        sample.place = place;
        const float at = float(x) + place.x;
        sample.seen = at < kPlace ? SeenByRay::ground_at(glm::vec3(0.5f), 1, {.indirect = glm::vec3(1)})
                                  : SeenByRay::surroundings(glm::vec3(3 + slope * (at - kPlace)));
        return sample;
    }
    double filtered(int x) const {
        double sum = 0, weights = 0;
        for (int i = 0; i < 3000; ++i) {
            const float offset = -1.5f + (float(i) + 0.5f) / 1000, at = float(x) + 0.5f + offset;
            const double weight = double(pixel_filter(offset));
            sum += weight * (at < kPlace ? 1 : 3 + double(slope * (at - kPlace)));
            weights += weight;
        }
        return sum / weights;
    }
};

/// `shaded` rays a square that R2 places as it likes, and as many times as many coverage rays.
Picture edge_picture(const Edge& edge, int shaded, int coverage) {
    const PictureOptions options = small_picture(9, 3);
    const CameraFrame frame = camera_frame(camera_at({0, 0, 1}, {0, 0, 0}), 9, 3);
    Film film(options, frame);
    for (int band = 0; band < film.band_count(); ++band)
        for (int y = film.first_row(band); y < film.end_row(band); ++y)
            for (int x = -1; x <= 9; ++x) {
                std::vector<CameraSample> samples;
                std::vector<CoverageRay> more;
                for (int k = 0; k < (1 + coverage) * shaded; ++k) {
                    const CameraSample sample =
                        edge.sample(x, evenly_spread(std::uint32_t(k), std::uint32_t(17 * x + 131 * y)));
                    if (k < shaded)
                        samples.push_back(sample);
                    else
                        more.push_back({sample.place, sample.seen.part});
                }
                film.add(band, x, y, samples, more);
            }
    return film.picture();
}

double worst_error(const Edge& edge, int shaded, int coverage) {
    const Picture picture = edge_picture(edge, shaded, coverage);
    double worst = 0;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 9; ++x)
            worst = std::max(worst, std::abs(double(picture.radiance.at(x, y)[0]) - edge.filtered(x)));
    return worst;
}

TEST(Film, CoverageRaysPlaceEdgesThatFewShadedRaysMisplace) {
    const Edge flat;
    const double without = worst_error(flat, 8, 0), with = worst_error(flat, 8, 8);
    EXPECT_GT(without, 0.05);
    EXPECT_LT(with, without / 3);
}

TEST(Film, CoverageKeepsTheShadedRaysOwnSlopeWithinAPart) {
    // Were each part's mean spread over its square, the steep side would be blurred by a pixel.
    const Edge steep{2};
    EXPECT_LT(worst_error(steep, 64, 3), 0.02);
    EXPECT_LT(worst_error(steep, 64, 3), worst_error(steep, 64, 0));
}

TEST(Film, WhatNoShadedRayMetLooksAsSurfacesDoOrAsAnything) {
    const PictureOptions options = small_picture(1, 1);
    const CameraFrame frame = camera_frame(camera_at({0, 0, 1}, {0, 0, 0}), 1, 1);
    const auto pixel = [&](bool with_surface) {
        Film film(options, frame);
        CameraSample sky, surface;
        sky.seen = SeenByRay::surroundings(glm::vec3(1));
        surface.seen.radiance = glm::vec3(5);
        surface.seen.surface = true;
        surface.seen.part = seen_part::of_patch(3, true);
        std::vector<CameraSample> samples{sky};
        if (with_surface)
            samples.push_back(surface);
        const CoverageRay unknown{glm::vec2(0.5f), seen_part::of_patch(7, false)};
        for (int band = 0; band < film.band_count(); ++band)
            for (int y = film.first_row(band); y < film.end_row(band); ++y)
                for (int x = -1; x <= 1; ++x)
                    film.add(band, x, y, samples, std::vector{unknown, unknown});
        return film.picture().radiance.at(0, 0)[0];
    };
    EXPECT_NEAR(pixel(true), (1 + 3 * 5) / 4., 1e-5); // one of four is sky
    EXPECT_NEAR(pixel(false), 1, 1e-6);
}

CameraSample sample_of(std::uint32_t part, float radiance) {
    CameraSample sample;
    sample.seen.part = part;
    sample.seen.radiance = glm::vec3(radiance);
    return sample;
}

TEST(RadianceSpread, TellsTheVarianceBetweenPartsFromThatWithin) {
    RadianceSpread spread =
        spread_of(std::vector{sample_of(0, 1), sample_of(0, 3), sample_of(5, 11), sample_of(5, 13)});
    EXPECT_DOUBLE_EQ(spread.variance().r, (36 + 16 + 16 + 36) / 3.);
    EXPECT_DOUBLE_EQ(spread.variance_in_parts().r, 2);
    EXPECT_DOUBLE_EQ(spread.deviation(0), std::sqrt(104 / 3.));
    // Parts of one ray each tell nothing about the variance within any; beside others they add to the whole alone.
    const RadianceSpread alone = spread_of(std::vector{sample_of(0, 1), sample_of(5, 11)});
    EXPECT_EQ(alone.variance_in_parts(), alone.variance());
    spread.add(alone);
    EXPECT_DOUBLE_EQ(spread.variance().r, (104 + 50) / 4.);
    EXPECT_DOUBLE_EQ(spread.variance_in_parts().r, 2);
    EXPECT_EQ(spread_of(std::vector{sample_of(0, 1)}).deviation(0), 0);
    EXPECT_EQ(RadianceSpread().coverage_rays(), 0);
}

TEST(RadianceSpread, AsksForCoverageAsFarAsTheVarianceIsBetweenParts) {
    const auto rays = [](float between, float within) {
        return spread_of(std::vector{sample_of(0, 0), sample_of(0, within), sample_of(5, between),
                                     sample_of(5, between + within)})
            .coverage_rays();
    };
    EXPECT_EQ(rays(0, 1), 0);
    EXPECT_EQ(rays(0.1f, 1), 0);
    EXPECT_EQ(rays(1, 0), 4);
    EXPECT_GE(rays(2, 1), 1);
    EXPECT_LT(rays(2, 1), 4);
    // As many coverage rays as it asks for leave less deviation for the cost than none.
    const RadianceSpread spread =
        spread_of(std::vector{sample_of(0, 0), sample_of(0, 1), sample_of(5, 6), sample_of(5, 7)});
    EXPECT_LT(spread.deviation(spread.coverage_rays()), 0.6 * spread.deviation(0));
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

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
                film.add(band, x, y, {samples, {}, {}});
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
                film.add(band, x, y, {samples, more, {}});
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

/// A crown of many small parts: surroundings take a tenth of each square, one large part six tenths, and thirty small
/// ones, which are brighter, a hundredth each. They begin elsewhere in every square, because the filters of
/// neighbouring pixels don't add up to quite the same everywhere.
struct SmallParts {
    static constexpr double kMean = 0.1 * 20 + 0.6 * 1 + 0.3 * 5;

    static CameraSample sample(const glm::vec2& place, float begin) {
        CameraSample sample;
        sample.place = place;
        const float at = glm::fract(place.x + begin);
        if (at < 0.1f) {
            sample.seen = SeenByRay::surroundings(glm::vec3(20));
            return sample;
        }
        const bool is_large = at < 0.7f;
        sample.seen.surface = true;
        sample.seen.part = seen_part::of_patch(is_large ? 0 : 1 + std::uint32_t((at - 0.7f) * 100), true);
        sample.seen.radiance = glm::vec3(is_large ? 1.f : 5.f);
        return sample;
    }
};

TEST(Film, CoverageFavoursNeitherLargePartsNorThoseThatShadedRaysHappenToMeet) {
    constexpr int kEdge = 48;
    constexpr std::uint32_t kShaded = 4, kAll = 20;
    const PictureOptions options = small_picture(kEdge, kEdge);
    Film film(options, camera_frame(camera_at({0, 0, 1}, {0, 0, 0}), kEdge, kEdge));
    for (int band = 0; band < film.band_count(); ++band)
        for (int y = film.first_row(band); y < film.end_row(band); ++y)
            for (int x = -1; x <= kEdge; ++x) {
                std::vector<CameraSample> shaded, looks;
                std::vector<CoverageRay> coverage;
                std::vector<std::uint32_t> parts;
                const auto at = [&](std::uint32_t k) {
                    return SmallParts::sample(evenly_spread(k, std::uint32_t(61 * x + 977 * y)),
                                              0.618f * float(x + 57 * y + 100));
                };
                for (std::uint32_t k = 0; k < kAll; ++k)
                    if (const CameraSample sample = at(k); k < kShaded) {
                        shaded.push_back(sample);
                        parts.push_back(sample.seen.part);
                    } else {
                        coverage.push_back({sample.place, sample.seen.part});
                    }
                for (const std::size_t ray : rays_of_unshaded_classes({coverage, parts}, coverage, parts))
                    looks.push_back(at(kShaded + std::uint32_t(ray)));
                film.add(band, x, y, {shaded, coverage, looks});
            }
    double sum = 0;
    const Picture picture = film.picture();
    for (const float value : picture.radiance.pixels)
        sum += double(value);
    EXPECT_NEAR(sum / double(picture.radiance.pixels.size()) / SmallParts::kMean, 1, 0.01);
}

TEST(Film, AClassWithoutAnyLookIsAsBrightAsTheSquare) {
    const PictureOptions options = small_picture(1, 1);
    Film film(options, camera_frame(camera_at({0, 0, 1}, {0, 0, 0}), 1, 1));
    CameraSample sky;
    sky.seen = SeenByRay::surroundings(glm::vec3(2));
    const std::vector<CameraSample> shaded{sky};
    const std::vector<CoverageRay> coverage(3, {glm::vec2(0.5f), seen_part::of_patch(7, false)});
    for (int band = 0; band < film.band_count(); ++band)
        for (int y = film.first_row(band); y < film.end_row(band); ++y)
            for (int x = -1; x <= 1; ++x)
                film.add(band, x, y, {shaded, coverage, {}});
    EXPECT_NEAR(film.picture().radiance.at(0, 0)[0], 2, 1e-5);
}

TEST(Film, CoverageTakesNoMoreThanAPixelHas) {
    PictureOptions options = small_picture(2, 2);
    options.layers = true;
    Film film(options, camera_frame(camera_at({0, 0, 1}, {0, 0, 0}), 2, 2));
    CameraSample dark, bright;
    dark.seen.part = bright.seen.part = seen_part::of_patch(1, true);
    dark.place = glm::vec2(0.01f);
    bright.place = glm::vec2(0.99f);
    bright.seen.direct = glm::vec3(1);
    for (int band = 0; band < film.band_count(); ++band)
        for (int y = film.first_row(band); y < film.end_row(band); ++y)
            for (int x = -1; x <= 2; ++x) {
                // All coverage lies where the pixel before hardly reaches.
                const bool is_covered = x == 1 && y == 1;
                const std::vector<CameraSample> shaded(1, dark), both{dark, bright};
                const std::vector<CoverageRay> coverage(6, {bright.place, bright.seen.part});
                film.add(band, x, y, is_covered ? SquareSamples{both, coverage, {}} : SquareSamples{shaded, {}, {}});
            }
    const Picture picture = film.picture();
    EXPECT_EQ(picture.layers->direct.at(0, 0)[0], 0);
    EXPECT_GT(picture.layers->direct.at(1, 1)[0], 0);
}

TEST(CoverageClasses, KeepApartWhatTwoShadedRaysShouldHaveMet) {
    const std::uint32_t large = seen_part::of_patch(4, true), other_side = seen_part::of_patch(4, false),
                        small = seen_part::of_patch(9, true);
    std::vector<CoverageRay> coverage(16, {glm::vec2(0.5f), large});
    coverage[3].part = coverage[5].part = small;
    coverage[7].part = other_side;
    coverage[8].part = seen_part::kSurroundings;
    const std::vector<std::uint32_t> met(4, large);
    const CoverageClasses classes(coverage, met); // two of four: ten of twenty
    EXPECT_EQ(classes.of(large), large);
    EXPECT_EQ(classes.of(small), classes.of(other_side));
    EXPECT_EQ(classes.of(small), classes.of(seen_part::of_patch(100, true)));
    EXPECT_NE(classes.of(small), classes.of(large));
    EXPECT_EQ(classes.of(seen_part::kSurroundings), seen_part::kSurroundings);
    EXPECT_EQ(classes.of(seen_part::kGround), seen_part::kGround);
    EXPECT_EQ(rays_of_unshaded_classes(classes, coverage, met), (std::vector<std::size_t>{3, 8}));
    const std::vector<std::uint32_t> all{large, other_side, seen_part::kSurroundings};
    EXPECT_TRUE(rays_of_unshaded_classes(classes, coverage, all).empty());
    EXPECT_TRUE(rays_of_unshaded_classes(classes, {}, {}).empty());
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
    // Surfaces of one ray each are one class, surroundings another.
    const RadianceSpread small = spread_of(std::vector{sample_of(5, 1), sample_of(7, 11)});
    EXPECT_EQ(small.variance_in_parts(), small.variance());
    const RadianceSpread alone = spread_of(std::vector{sample_of(0, 1), sample_of(5, 11)});
    EXPECT_EQ(alone.variance_in_parts(), alone.variance()); // for want of any other number
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

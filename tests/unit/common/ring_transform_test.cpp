#include "common/directions/lobes.h"
#include "common/directions/ring_product.h"
#include "common/directions/ring_transform.h"
#include "common/directions/spherical_harmonics.h"
#include "common/directions/zonal.h"
#include "common/environment/lat_long.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "tests/unit/common/random_image.h"

#include <complex>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

using test::random_image;

/// The slow twin of the analysis: every pixel's harmonics, in the frame whose polar axis is +Y.
std::vector<glm::dvec3> slow_analysis(const Image& image, int bands) {
    std::vector<glm::dvec3> sum(sh_count(bands), glm::dvec3(0));
    std::vector<double> harmonics(sh_count(bands));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const glm::dvec3 d = pixel_direction(x, y, image.width, image.height);
            evaluate_sh(bands, glm::dvec3(d.x, d.z, d.y), harmonics);
            const float* p = image.at(x, y);
            const glm::dvec3 value = pixel_solid_angle(y, image.width, image.height) * glm::dvec3(p[0], p[1], p[2]);
            for (std::size_t k = 0; k < sum.size(); ++k)
                sum[k] += harmonics[k] * value;
        }
    return sum;
}

TEST(BatchFft, IsTheSumThatDefinesIt) {
    for (const int length : {1, 2, 3, 4, 5, 6, 7, 8, 22, 30, 48, 97, 128, 150}) {
        const BatchFft fft(length);
        std::vector<float> values(fft.floats()), scratch(fft.floats());
        Random random(std::uint64_t(length), 0);
        for (float& value : values)
            value = random.uniform() - 0.5f;
        const std::vector<float> before = values;
        for (const bool forward : {true, false}) {
            values = before;
            const std::span<float> result = forward ? fft.forward(values, scratch) : fft.backward(values, scratch);
            double worst = 0;
            for (std::size_t lane = 0; lane < BatchFft::kLanes; ++lane)
                for (int k = 0; k < length; ++k) {
                    std::complex<double> sum = 0;
                    for (int n = 0; n < length; ++n) {
                        const float* element = before.data() + std::size_t(n) * BatchFft::kElement + lane;
                        sum += std::complex<double>(element[0], element[BatchFft::kLanes]) *
                               std::polar(1.0, (forward ? -2 : 2) * kPiDouble * k * n / length);
                    }
                    const float* element = result.data() + std::size_t(k) * BatchFft::kElement + lane;
                    worst =
                        std::max(worst, std::abs(sum - std::complex<double>(element[0], element[BatchFft::kLanes])));
                }
            EXPECT_LT(worst, 1e-6 * std::sqrt(length)) << length << (forward ? " forward" : " backward");
        }
    }
}

TEST(RingProduct, AnalysisIsTheSumThatDefinesIt) {
    Random random(1, 2);
    for (const std::size_t count : {16u, 32u, 48u, 64u, 112u}) {
        const std::size_t rows = 7;
        std::vector<float> table(rows * count), values(rows * 6), result(6 * count);
        for (float& v : table)
            v = random.uniform();
        for (float& v : values)
            v = random.uniform();
        ring_analysis_product(table.data(), rows, count, values.data(), result.data());
        for (std::size_t c = 0; c < 6; ++c)
            for (std::size_t i = 0; i < count; ++i) {
                double sum = 0;
                for (std::size_t k = 0; k < rows; ++k)
                    sum += double(table[k * count + i]) * double(values[k * 6 + c]);
                ASSERT_NEAR(result[c * count + i], sum, 2e-6) << count << " " << c << " " << i;
            }
    }
}

TEST(RingProduct, SynthesisIsTheSumThatDefinesIt) {
    Random random(1, 3);
    for (std::size_t functions = 1; functions <= RingSynthesis::kMostGrids; ++functions) {
        const std::size_t rows = 9, column = 11;
        std::vector<float> table(rows * 16), coefficients(6 * column), zonal(functions * rows),
            result(functions * 6 * 16);
        for (std::vector<float>* values : {&table, &coefficients, &zonal})
            for (float& v : *values)
                v = random.uniform();
        std::vector<const float*> zonals;
        for (std::size_t f = 0; f < functions; ++f)
            zonals.push_back(zonal.data() + f * rows);
        ring_synthesis_product(table.data(), rows, coefficients.data(), column, zonals.data(), functions,
                               result.data());
        for (std::size_t f = 0; f < functions; ++f)
            for (std::size_t c = 0; c < 6; ++c)
                for (std::size_t i = 0; i < 16; ++i) {
                    double sum = 0;
                    for (std::size_t k = 0; k < rows; ++k)
                        sum += double(table[k * 16 + i]) * double(zonals[f][k]) * double(coefficients[c * column + k]);
                    ASSERT_NEAR(result[(f * 6 + c) * 16 + i], sum, 2e-6) << f << " " << c << " " << i;
                }
    }
}

TEST(RingAnalysis, IsTheSumOverPixels) {
    struct Case {
        int width, height, bands;
    };
    // Few pixels and many bands: beyond the image's own waves too. Odd heights, one row, one column.
    for (const Case& c : {Case{32, 16, 20}, Case{12, 7, 40}, Case{1, 1, 9}, Case{2, 1, 12}, Case{9, 33, 70}}) {
        const Image image = random_image(c.width, c.height, 5);
        const RingAnalysis analysis(c.width, c.height, c.bands);
        RingCoefficients coefficients(c.bands);
        analysis.transform(image, 2, coefficients);
        const std::vector<glm::dvec3> slow = slow_analysis(image, c.bands);
        double worst = 0;
        for (int l = 0; l < c.bands; ++l)
            for (int m = 0; m <= l; ++m) {
                const int parity = (l - m) % 2, i = (l - m) / 2, padded = coefficients.padded(m, parity);
                const float* values = coefficients.values(m, parity);
                for (int channel = 0; channel < 3; ++channel) {
                    const auto k = glm::length_t(channel);
                    worst =
                        std::max(worst, std::abs(2 * slow[sh_index(l, m)][k] - double(values[channel * padded + i])));
                    const double b = m > 0 ? slow[sh_index(l, -m)][k] : 0;
                    worst = std::max(worst, std::abs(-2 * b - double(values[(channel + 3) * padded + i])));
                }
            }
        EXPECT_LT(worst, 2e-5) << c.width << " x " << c.height << ", " << c.bands << " bands";
    }
}

TEST(RingSynthesis, IsTheSeriesOnTheRingsAndBetweenThem) {
    const Image image = random_image(48, 24, 7);
    const int bands = 24;
    const RingAnalysis analysis(48, 24, bands);
    RingCoefficients coefficients(bands);
    analysis.transform(image, 1, coefficients);
    const std::vector<double> zonal = phong_lobe(bands, 60);
    std::vector<glm::dvec3> filtered = slow_analysis(image, bands);
    for (int l = 0; l < bands; ++l)
        for (int m = -l; m <= l; ++m)
            filtered[sh_index(l, m)] *= 3 * zonal[std::size_t(l)];
    auto truth = [&](const glm::dvec3& d) {
        std::vector<double> harmonics(sh_count(bands));
        evaluate_sh(bands, glm::dvec3(d.x, d.z, d.y), harmonics);
        glm::dvec3 sum(0);
        for (std::size_t k = 0; k < filtered.size(); ++k)
            sum += harmonics[k] * filtered[k];
        return sum;
    };
    for (const int rings : {50, 75, 200}) {
        const RingSynthesis synthesis(bands, rings, 2 * rings);
        std::vector<RingGrid> grids(2, RingGrid(rings, 2 * rings));
        synthesis.transform(coefficients, std::vector<std::vector<double>>{{1.0, 0.5}, zonal}, 3, grids);
        const RingGrid& grid = grids[1];
        double on_rings = 0, between = 0;
        for (int y = 0; y < rings; y += 3)
            for (int x = 0; x < 2 * rings; x += 5) {
                const double polar = (y + 0.5) / rings * kPiDouble, azimuth = double(x) / rings * kPiDouble;
                const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                   std::sin(polar) * std::sin(azimuth));
                on_rings = std::max(on_rings, glm::length(truth(d) - glm::dvec3(grid.lookup(d))));
            }
        Random random(3, 4);
        for (int i = 0; i < 400; ++i) {
            const double height = i == 0   ? 1
                                  : i == 1 ? -1
                                           : 2 * double(random.uniform()) - 1,
                         azimuth = 7 * double(random.uniform());
            const double sine = std::sqrt(1 - height * height);
            const glm::dvec3 d(sine * std::cos(azimuth), height, sine * std::sin(azimuth));
            between = std::max(between, glm::length(truth(d) - glm::dvec3(grid.lookup(d))));
        }
        EXPECT_LT(on_rings, 1e-5) << rings;
        EXPECT_LT(between, rings == 200 ? 2e-5 : rings == 75 ? 5e-4 : 5e-3) << rings;
    }
}

TEST(RingTransform, SameBitsWithAnyNumberOfThreads) {
    const Image image = random_image(96, 48, 11);
    const int bands = 60;
    auto run = [&](int threads) {
        set_thread_count(threads);
        RingCoefficients coefficients(bands);
        RingAnalysis(96, 48, bands).transform(image, 1, coefficients);
        std::vector<RingGrid> grids(1, RingGrid(80, 128));
        const RingGrid& grid = grids[0];
        RingSynthesis(bands, 80, 128)
            .transform(coefficients, std::vector<std::vector<double>>{phong_lobe(bands, 100)}, 1, grids);
        set_thread_count(0);
        std::vector<glm::vec4> cells;
        for (int y = 0; y < 80; ++y)
            for (int x = 0; x < 128; ++x)
                cells.push_back(grid.at(y, x));
        return cells;
    };
    EXPECT_EQ(run(1), run(2));
}

} // namespace

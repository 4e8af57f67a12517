// Relief from normal maps: against heights that the normals were made of.
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/types.h"
#include "reflection/relief/integrate_normals.h"
#include "tests/benchmark/relief_maps.h"

#include <cmath>
#include <cstdlib>
#include <gtest/gtest.h>
#include <limits>

using namespace kokage;

namespace {

/// Heights in metres and their normal map, OpenGL: green up.
struct Surface {
    Image heights, normals;
};

/// height(u, v) on a tile of `tile_m`; slopes by central differences of the formula.
Surface surface_of(int width, int height, const glm::dvec2& tile_m, auto&& heights) {
    Surface surface{Image(width, height, 1), Image(width, height, 3)};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double u = (x + 0.5) / width, v = (y + 0.5) / height, e = 1e-5;
            *surface.heights.at(x, y) = float(heights(u, v));
            const double du = (heights(u + e, v) - heights(u - e, v)) / (2 * e) / tile_m.x,
                         dv = (heights(u, v + e) - heights(u, v - e)) / (2 * e) / tile_m.y;
            const glm::dvec3 normal = glm::normalize(glm::dvec3(-du, dv, 1));
            for (int c = 0; c < 3; ++c)
                surface.normals.at(x, y)[c] = float(0.5 + 0.5 * normal[c]);
        }
    return surface;
}

struct Fit {
    double correlation = 0, rms = 0; ///< of a scale and an offset of the second that come nearest to the first
    double gain = 0;
};

Fit fit(const std::vector<double>& truth, const std::vector<double>& found) {
    const double n = double(truth.size());
    double t = 0, f = 0, tt = 0, ff = 0, tf = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        t += truth[i] / n;
        f += found[i] / n;
    }
    for (std::size_t i = 0; i < truth.size(); ++i) {
        tt += (truth[i] - t) * (truth[i] - t) / n;
        ff += (found[i] - f) * (found[i] - f) / n;
        tf += (truth[i] - t) * (found[i] - f) / n;
    }
    return {tf / std::sqrt(tt * ff), std::sqrt(std::max(0., tt - tf * tf / ff)), tf / ff};
}

std::vector<double> heights_m(const Relief& relief) {
    std::vector<double> heights;
    for (const float depth : relief.field.depths)
        heights.push_back(-double(depth) * double(relief.scale.depth_m));
    return heights;
}

std::vector<double> doubles(const std::vector<float>& values) {
    return {values.begin(), values.end()};
}

/// Both slopes, over `step` texels.
std::vector<double> slopes(const HeightField& field, int step) {
    std::vector<double> result;
    for (int y = 0; y + step < field.height; ++y)
        for (int x = 0; x + step < field.width; ++x) {
            result.push_back(double(field.depth(x + step, y)) - double(field.depth(x, y)));
            result.push_back(double(field.depth(x, y + step)) - double(field.depth(x, y)));
        }
    return result;
}

Relief integrate(const Image& normals, const NormalMapOptions& options) {
    NormalMapReport report;
    return relief_from_normals(normals, "map", options, report);
}

double wave_height(double u, double v) {
    constexpr double turn = 2 * kPiDouble;
    return 0.01 * std::sin(turn * (2 * u + v)) + 0.004 * std::cos(turn * (5 * v - 3 * u)) + 0.006 * std::sin(turn * u);
}

TEST(ReliefNormalMap, GivesThePeriodicHeightsBackInMetres) {
    for (const glm::ivec2 size : {glm::ivec2(64, 64), glm::ivec2(60, 37), glm::ivec2(33, 128)}) {
        const glm::dvec2 tile(0.5, 0.8);
        const Surface surface = surface_of(size.x, size.y, tile, wave_height);
        const Relief relief = integrate(surface.normals, {.tile_m = glm::vec2(tile)});
        const Fit match = fit(doubles(surface.heights.pixels), heights_m(relief));
        EXPECT_NEAR(match.gain, 1, 1e-4) << size.x << " x " << size.y;
        EXPECT_LT(match.rms, 2e-6); // of 0.03 m
        EXPECT_EQ(*std::min_element(relief.field.depths.begin(), relief.field.depths.end()), 0.f);
        EXPECT_EQ(*std::max_element(relief.field.depths.begin(), relief.field.depths.end()), 1.f);
    }
}

TEST(ReliefNormalMap, TakesGreenUpAndDown) {
    Surface surface = surface_of(48, 48, {1, 1}, wave_height);
    for (std::size_t i = 1; i < surface.normals.pixels.size(); i += 3)
        surface.normals.pixels[i] = 1 - surface.normals.pixels[i];
    NormalMapReport right, wrong;
    const Relief down = relief_from_normals(surface.normals, "map", {.green = NormalMapGreen::down}, right);
    EXPECT_LT(fit(doubles(surface.heights.pixels), heights_m(down)).rms, 2e-6);
    EXPECT_LT(right.curl, 1e-3);
    relief_from_normals(surface.normals, "map", {}, wrong);
    EXPECT_GT(wrong.curl, 0.5);
    ASSERT_EQ(wrong.notes.size(), 1u);
    EXPECT_NE(wrong.notes[0].find("DirectX"), std::string::npos);
}

TEST(ReliefNormalMap, IntegratesMapsThatDoNotRepeat) {
    const auto hill = [](double u, double v) { return 0.05 * std::exp(-3 * (u * u + 2 * (v - 0.2) * (v - 0.2))); };
    const Surface surface = surface_of(96, 70, {1, 1}, hill);
    // The mean slope is taken off: of the truth as well.
    glm::dvec2 tilt(0.);
    for (int i = 0; i < 1000; ++i) {
        const double at = (i + 0.5) / 1000;
        tilt += glm::dvec2(hill(1, at) - hill(0, at), hill(at, 1) - hill(at, 0)) / 1000.;
    }
    std::vector<double> truth = doubles(surface.heights.pixels);
    for (std::size_t i = 0; i < truth.size(); ++i)
        truth[i] -= tilt.x * double(i % 96) / 96 + tilt.y * double(i / 96) / 70;
    const Fit mirrored = fit(truth, heights_m(integrate(surface.normals, {.wrap = HeightWrap::clamp}))),
              periodic = fit(truth, heights_m(integrate(surface.normals, {})));
    EXPECT_GT(mirrored.correlation, 0.999);
    EXPECT_NEAR(mirrored.gain, 1, 0.02);
    EXPECT_LT(periodic.correlation, 0.99);
}

// What the method itself loses on the benchmark's bark, from normals of 8 bits too.
TEST(ReliefNormalMap, GivesBarkBack) {
    const HeightField bark = make_relief_map(ReliefMap::bark, 256, 256);
    Image normals(256, 256, 3);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 256; ++x) {
            const auto height = [&](int i, int j) {
                return -double(kBenchReliefDepth) * double(bark.depth((i + 256) % 256, (j + 256) % 256));
            };
            const glm::dvec3 n = glm::normalize(glm::dvec3(128 * (height(x - 1, y) - height(x + 1, y)),
                                                           128 * (height(x, y + 1) - height(x, y - 1)), 1));
            for (int c = 0; c < 3; ++c)
                normals.at(x, y)[c] = float(0.5 + 0.5 * n[c]);
        }
    std::vector<double> truth;
    for (const float depth : bark.depths)
        truth.push_back(-double(kBenchReliefDepth * depth));
    const Fit exact = fit(truth, heights_m(integrate(normals, {})));
    EXPECT_GT(exact.correlation, 0.99);
    EXPECT_NEAR(exact.gain, 1, 0.05);
    for (float& value : normals.pixels)
        value = std::round(255 * value) / 255;
    const Fit stored = fit(truth, heights_m(integrate(normals, {})));
    EXPECT_GT(stored.correlation, 0.99);
    RecordProperty("rms_of_depth", std::to_string(exact.rms / double(kBenchReliefDepth)));
    RecordProperty("rms_of_depth_8_bits", std::to_string(stored.rms / double(kBenchReliefDepth)));
    EXPECT_LT(stored.rms, 0.02 * double(kBenchReliefDepth));
}

TEST(ReliefNormalMap, RepairsOrRefusesWhatIsNoNormal) {
    Surface surface = surface_of(32, 32, {1, 1}, wave_height);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    surface.normals.at(3, 5)[1] = nan;
    surface.normals.at(4, 5)[2] = 0.2f; // faces down
    for (int c = 0; c < 3; ++c)
        surface.normals.at(20, 20)[c] = 0.5f; // no length
    NormalMapReport report;
    const Relief relief = relief_from_normals(surface.normals, "map", {}, report);
    EXPECT_EQ(report.repaired, 3u);
    EXPECT_EQ(report.notes.size(), 1u);
    EXPECT_LT(fit(doubles(surface.heights.pixels), heights_m(relief)).rms, 2e-4);
    EXPECT_THROW(relief_from_normals(surface.normals, "map", {.strict = true}, report), InputError);
    EXPECT_THROW(integrate(Image(4, 4, 3), {}), InputError); // black: all face down
    EXPECT_THROW(integrate(Image(4, 4, 1), {}), InputError);
    EXPECT_THROW(integrate(Image(), {}), InputError);
    EXPECT_THROW(integrate(surface.normals, {.tile_m = {0, 1}}), InputError);
    EXPECT_THROW(integrate(surface.normals, {.tile_m = {nan, 1}}), InputError);
}

TEST(ReliefNormalMap, TakesFlatAndSmallAndSteepMaps) {
    for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(1, 7), glm::ivec2(8, 5)})
        for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp}) {
            Image flat(size.x, size.y, 3);
            for (std::size_t i = 0; i < flat.pixels.size(); ++i)
                flat.pixels[i] = i % 3 == 2 ? 1.f : 128.f / 255;
            const Relief relief = integrate(flat, {.wrap = wrap});
            EXPECT_LT(relief.scale.depth_m, 1e-6f);
            EXPECT_EQ(relief.field.depths.size(), std::size_t(size.x) * std::size_t(size.y));
        }
    Image steep(8, 1, 3);
    for (int x = 0; x < 8; ++x) {
        steep.at(x, 0)[0] = x % 4 < 2 ? 0.f : 1.f;
        steep.at(x, 0)[1] = 0.5f;
        steep.at(x, 0)[2] = 0.5f + 1e-6f;
    }
    NormalMapReport report;
    const Relief relief = relief_from_normals(steep, "map", {}, report);
    EXPECT_EQ(report.steep, 8u);
    EXPECT_LT(relief.scale.depth_m, 16 * 0.5f);
}

// The scanned willow bark comes with both. Its heights step where bark overhangs, which normals know nothing of.
TEST(ReliefNormalMap, MeasuresUpToScannedBark) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA names no folder of real data";
    const std::filesystem::path folder = std::filesystem::path(data) / "textures";
    HeightImageReport heights_report;
    NormalMapReport report;
    const Relief heights = load_relief(folder / "bark_willow_disp.png", {}, {}, heights_report);
    const Relief found = load_relief_from_normals(folder / "bark_willow_nor_gl.png", {}, report);
    const Fit depths = fit(doubles(heights.field.depths), doubles(found.field.depths));
    const Fit fine = fit(slopes(heights.field, 2), slopes(found.field, 2)),
              broad = fit(slopes(heights.field, 8), slopes(found.field, 8));
    RecordProperty("heights_correlation", std::to_string(depths.correlation));
    RecordProperty("heights_rms", std::to_string(depths.rms));
    RecordProperty("slopes_correlation", std::to_string(fine.correlation));
    EXPECT_GT(depths.correlation, 0.62); // measured 0.641
    EXPECT_LT(depths.rms, 0.106);        // of a depth of 1; the heights' own spread is 0.135
    EXPECT_GT(fine.correlation, 0.58);   // measured 0.599
    EXPECT_GT(broad.correlation, 0.75);  // measured 0.765
    NormalMapReport wrong;
    load_relief_from_normals(folder / "bark_willow_nor_gl.png", {.green = NormalMapGreen::down}, wrong);
    EXPECT_GT(wrong.curl, 0.75);
    EXPECT_LT(report.curl, 0.5);
}

} // namespace

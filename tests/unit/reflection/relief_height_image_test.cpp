// Height maps as images.
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "common/types.h"
#include "reflection/relief/height_field_image.h"
#include "reflection/relief/tiling.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/support/temporary_folder.h"
#include "trees/growth/bark_image.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace kokage;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();

Image image_of(int width, int height, auto&& value) {
    Image image(width, height, 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            *image.at(x, y) = float(value(x, y));
    return image;
}

Relief relief_of(const Image& image, const HeightImageOptions& options = {}) {
    HeightImageReport report;
    return relief_from_image(image, {{1, 1}, 0.12f}, "map", options, report);
}

std::string error_of(auto&& body) {
    try {
        body();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(ReliefHeightImage, ReadsFilesOfAnyDepthAndSize) {
    const TemporaryFolder folder;
    const Image image = image_of(7, 3, [](int x, int y) { return (x + 7 * y) / 20.; });
    save_image(folder / "8.png", image, {PngEncoding::as_is, 8});
    save_image(folder / "16.png", image, {PngEncoding::as_is, 16});
    save_image(folder / "float.exr", image);
    const std::pair<const char*, double> files[] = {{"8.png", 0.5 / 255}, {"16.png", 0.5 / 65535}, {"float.exr", 1e-7}};
    for (const auto& [name, step] : files) {
        HeightImageReport report;
        const Relief relief = load_relief(folder / name, {{2, 3}, 0.12f}, {}, report);
        EXPECT_EQ(relief.field.width, 7);
        EXPECT_EQ(relief.field.height, 3);
        EXPECT_EQ(relief.scale.tile_m, glm::vec2(2, 3));
        EXPECT_EQ(relief.scale.depth_m, 0.12f);
        for (std::size_t i = 0; i < image.pixels.size(); ++i)
            EXPECT_NEAR(relief.field.depths[i], 1 - image.pixels[i], step * 1.01) << name;
    }
    EXPECT_NE(error_of([&] {
                  HeightImageReport report;
                  load_relief(folder / "none.png", {}, {}, report);
              }).find("none.png"),
              std::string::npos);
}

TEST(ReliefHeightImage, WhiteIsHighUnlessBlackIs) {
    const Image image = image_of(3, 1, [](int x, int) { return x / 2.; });
    EXPECT_EQ(relief_of(image).field.depths, (std::vector<float>{1, 0.5f, 0}));
    EXPECT_EQ(relief_of(image, {.black_is_high = true}).field.depths, (std::vector<float>{0, 0.5f, 1}));
    EXPECT_EQ(relief_of(image, {.wrap = HeightWrap::clamp}).field.wrap, HeightWrap::clamp);
}

TEST(ReliefHeightImage, StretchesWhatLeavesTheRangeAndTheDepthWithIt) {
    const Image meters = image_of(3, 1, [](int x, int) { return 10 * x - 5; }); // -5, 5, 15
    HeightImageReport report;
    const Relief relief = relief_from_image(meters, {{1, 1}, 0.01f}, "map", {}, report);
    EXPECT_EQ(relief.field.depths, (std::vector<float>{1, 0.5f, 0}));
    EXPECT_FLOAT_EQ(relief.scale.depth_m, 0.2f);
    EXPECT_EQ(report.least, -5);
    EXPECT_EQ(report.most, 15);
    ASSERT_GE(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("-5 to 15"), std::string::npos);
    // Within the range, only when asked.
    const Image narrow = image_of(2, 1, [](int x, int) { return 0.25 + 0.25 * x; });
    EXPECT_EQ(relief_of(narrow).field.depths, (std::vector<float>{0.75f, 0.5f}));
    EXPECT_EQ(relief_of(narrow).scale.depth_m, 0.12f);
    EXPECT_EQ(relief_of(narrow, {.stretch = true}).field.depths, (std::vector<float>{1, 0}));
    EXPECT_FLOAT_EQ(relief_of(narrow, {.stretch = true}).scale.depth_m, 0.03f);
}

TEST(ReliefHeightImage, TakesConstantMaps) {
    for (const double height : {0., 0.5, 1.})
        EXPECT_EQ(relief_of(image_of(4, 2, [&](int, int) { return height; })).field.depths,
                  std::vector<float>(8, float(1 - height)));
    const Relief far = relief_of(image_of(4, 2, [](int, int) { return 1e30; }));
    EXPECT_EQ(far.field.depths, std::vector<float>(8, 0.f));
    EXPECT_EQ(far.scale.depth_m, 0.f);
    EXPECT_EQ(relief_of(image_of(1, 1, [](int, int) { return 0.25; }), {.make_tile = true}).field.depths,
              std::vector<float>{0.75f});
}

TEST(ReliefHeightImage, RepairsWhatIsNotFiniteAndSaysSo) {
    Image image = image_of(8, 8, [](int, int y) { return y / 10.; });
    *image.at(3, 4) = kNan;
    *image.at(4, 4) = kInfinity;
    *image.at(0, 0) = -kInfinity;
    HeightImageReport report;
    const Relief relief = relief_from_image(image, {}, "map", {.wrap = HeightWrap::clamp}, report);
    EXPECT_EQ(report.repaired, 3u);
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("3 heights"), std::string::npos);
    EXPECT_NEAR(relief.field.depth(3, 4), 0.6, 0.02); // its row's, by symmetry of those around
    EXPECT_NEAR(relief.field.depth(4, 4), 0.6, 0.02);
    EXPECT_NEAR(relief.field.depth(0, 0), 1 - 0.2 / 3 / 1, 0.05);
    for (const float depth : relief.field.depths)
        EXPECT_TRUE(depth >= 0 && depth <= 1);
    const std::string refusal = error_of([&] { relief_from_image(image, {}, "map", {.strict = true}, report); });
    EXPECT_NE(refusal.find("(0, 0)"), std::string::npos) << refusal;
    EXPECT_NE(error_of([] { relief_of(image_of(3, 3, [](int, int) { return kNan; })); }), "");
    // A single good texel fills a large map in no time.
    Image hole = image_of(1000, 500, [](int, int) { return kNan; });
    *hole.at(0, 0) = 0.25f;
    EXPECT_EQ(relief_of(hole).field.depths, std::vector<float>(500000, 0.75f));
}

TEST(ReliefHeightImage, TakesGreyInColorsAndRefusesColor) {
    Image grey(2, 2, 4), colored(2, 2, 3);
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            grey.pixels[4 * i + c] = float(i) / 4;
            colored.pixels[3 * i + c] = c == 1 ? 0.5f : 0.f;
        }
    EXPECT_EQ(relief_of(grey).field.depths, (std::vector<float>{1, 0.75f, 0.5f, 0.25f}));
    EXPECT_NE(error_of([&] { relief_of(colored); }).find("luminance"), std::string::npos);
    EXPECT_NEAR(relief_of(colored, {.luminance_of_color = true}).field.depths[2], 1 - 0.3576, 1e-6);
}

TEST(ReliefHeightImage, RefusesWhatIsNoImageAndNoScale) {
    HeightImageReport report;
    EXPECT_NE(error_of([] { relief_of(Image()); }), "");
    const Image one = image_of(1, 1, [](int, int) { return 0.; });
    for (const float bad : {0.f, -1.f, kNan, kInfinity})
        EXPECT_NE(error_of([&] { relief_from_image(one, {{1, bad}, 0.1f}, "map", {}, report); }), "");
    for (const float bad : {-1.f, kNan, kInfinity})
        EXPECT_NE(error_of([&] { relief_from_image(one, {{1, 1}, bad}, "map", {}, report); }), "");
    const Image huge = image_of(2, 1, [](int x, int) { return x == 0 ? -3e38 : 3e38; });
    EXPECT_NE(error_of([&] {
                  relief_from_image(huge, {{1, 1}, 1}, "map", {}, report);
              }).find("too far apart"),
              std::string::npos);
}

TEST(ReliefTiling, MeasuresTheSeam) {
    for (const ReliefMap map : {ReliefMap::bark, ReliefMap::spikes, ReliefMap::low}) {
        Image image(256, 256, 1);
        image.pixels = make_relief_map(map, 256, 256).depths;
        EXPECT_LT(std::max(seam_steps(image).x, seam_steps(image).y), kSeamShows) << relief_map_name(map);
    }
    const Image ramp = image_of(64, 32, [](int x, int) { return x / 63.; });
    EXPECT_NEAR(seam_steps(ramp).x, 63, 1e-3);
    EXPECT_EQ(seam_steps(ramp).y, 1);
    EXPECT_EQ(seam_steps(image_of(1, 1, [](int, int) { return 0.5; })), glm::dvec2(1));
    HeightImageReport report;
    relief_from_image(ramp, {}, "ramp", {}, report);
    ASSERT_EQ(report.notes.size(), 1u);
    EXPECT_NE(report.notes[0].find("along u"), std::string::npos);
    relief_from_image(ramp, {}, "ramp", {.wrap = HeightWrap::clamp}, report);
    EXPECT_TRUE(report.notes.empty());
}

// A cut-out of a map does not tile; its periodic part does, and is the map within, but for what is smooth.
TEST(ReliefTiling, MakesAMapTile) {
    const HeightField whole = make_relief_map(ReliefMap::bark, 256, 256);
    const Image cut = image_of(150, 101, [&](int x, int y) { return 1 - whole.depth(x, y) + 0.002 * x; });
    EXPECT_GT(seam_steps(cut).x, kSeamShows);
    const Image tile = periodic_part(cut);
    EXPECT_LT(seam_steps(tile).x, 1.5);
    EXPECT_LT(seam_steps(tile).y, 1.5);
    double mean = 0, laplacian = 0, own = 0;
    for (int y = 0; y < 101; ++y)
        for (int x = 0; x < 150; ++x) {
            mean += double(*tile.at(x, y)) - double(*cut.at(x, y));
            if (x == 0 || y == 0 || x == 149 || y == 100)
                continue;
            const auto bend = [&](auto&& at) {
                return double(at(x - 1, y)) + double(at(x + 1, y)) + double(at(x, y - 1)) + double(at(x, y + 1)) -
                       4 * double(at(x, y));
            };
            laplacian += std::pow(bend([&](int i, int j) { return *tile.at(i, j) - *cut.at(i, j); }), 2);
            own += std::pow(bend([&](int i, int j) { return *cut.at(i, j); }), 2);
        }
    EXPECT_NEAR(mean / (150 * 101), 0, 1e-5);
    EXPECT_LT(std::sqrt(laplacian / own), 1e-3);
    // What tiles already changes by less than a step between its texels.
    const Image periodic = image_of(30, 20, [](int x, int y) {
        return 0.5 + 0.4 * std::sin(2 * kPiDouble * (x + 0.5) / 30) * std::cos(2 * kPiDouble * (y + 0.5) / 20);
    });
    const Image again = periodic_part(periodic);
    for (std::size_t i = 0; i < again.pixels.size(); ++i)
        EXPECT_NEAR(again.pixels[i], periodic.pixels[i], 0.4 * 2 * kPiDouble / 20);
    HeightImageReport report;
    const Relief relief = relief_from_image(cut, {{1, 1}, 0.12f}, "cut", {.make_tile = true}, report);
    EXPECT_LT(std::max(report.seam.x, report.seam.y), 1.5);
    for (const float depth : relief.field.depths)
        EXPECT_TRUE(depth >= 0 && depth <= 1);
    // In metres it is the periodic part.
    EXPECT_NEAR((relief.field.depth(20, 20) - relief.field.depth(90, 70)) * relief.scale.depth_m,
                (*tile.at(90, 70) - *tile.at(20, 20)) * 0.12f, 1e-5);
}

// The bark that trees draw comes as images.
TEST(ReliefHeightImage, TakesTheBarkOfTrees) {
    for (std::size_t kind = 0; kind < bark_kind_names().size(); ++kind) {
        const BarkImage bark = bark_image(BarkKind(kind), 1, 128);
        HeightImageReport report;
        const Relief relief =
            relief_from_image(bark.height, {{0.5f, 0.5f}, bark.depth_m}, bark_kind_names()[kind], {}, report);
        EXPECT_EQ(relief.field.width, 128);
        EXPECT_EQ(relief.scale.depth_m, bark.depth_m);
        EXPECT_TRUE(report.notes.empty()) << report.notes[0];
        EXPECT_LT(std::max(report.seam.x, report.seam.y), 2) << bark_kind_names()[kind];
        for (std::size_t i = 0; i < relief.field.depths.size(); ++i)
            ASSERT_FLOAT_EQ(relief.field.depths[i], 1 - bark.height.pixels[i]);
    }
}

} // namespace

// `kokage compare` on pictures and reflection maps.
#include "common/scene/image_file.h"
#include "common/scene/image_layers.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/map_file.h"
#include "tests/support/program_run.h"

#include <limits>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

Image grey_ramp(float offset) {
    Image image(8, 4, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i)
        image.pixels[i] = 0.25f + 0.5f * float(i) / float(image.pixels.size()) + offset;
    return image;
}

TEST(Compare, EqualPicturesHaveNoError) {
    TemporaryFolder folder;
    save_image(folder / "a.exr", grey_ramp(0));
    const ProgramRun run =
        run_kokage({"compare", "a.exr", "a.exr", "--report", "r.json", "-o", "map.png"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto report = nlohmann::json::parse(read_text(folder / "r.json"));
    for (const char* figure : {"mean", "rms", "p95", "max", "bias", "mean_relative"})
        EXPECT_EQ(report["error"][figure], 0) << figure;
    EXPECT_EQ(folder.files(), std::vector<std::string>({"a.exr", "map.png", "r.json"}));
}

TEST(Compare, FiguresAndMapAreWritten) {
    TemporaryFolder folder;
    save_image(folder / "a.exr", grey_ramp(0.125f));
    save_image(folder / "b.exr", grey_ramp(0));
    const ProgramRun run =
        run_kokage({"compare", "a.exr", "b.exr", "--report", "r.json", "-o", "map.png"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto report = nlohmann::json::parse(read_text(folder / "r.json"));
    EXPECT_NEAR(double(report["error"]["bias"]), 0.125, 1e-6);
    EXPECT_NEAR(double(report["error"]["rms"]), 0.125, 1e-6);
    EXPECT_NE(run.output.find("error of 256         mean 31.8"), std::string::npos) << run.output; // 0.125 x 255
    const Image map = load_image(folder / "map.png");
    EXPECT_EQ(map.width, 8);
    EXPECT_EQ(map.height, 4);
    EXPECT_NE(run.output.find("error map: map.png"), std::string::npos);
    EXPECT_NE(run.output.find("black 0, violet 0.0312, red-purple 0.0625, orange 0.0938, pale yellow 0.125 and above"),
              std::string::npos)
        << run.output;
    EXPECT_NEAR(double(report["error_map"]["brightest_at"]), 0.125, 1e-6);
    EXPECT_NE(run.output.find(std::string(report["error_map"]["colours"])), std::string::npos);
    EXPECT_TRUE(report["warnings"].empty());
    EXPECT_EQ(run.errors, "");
}

TEST(Compare, LayersAreComparedByWhatTheyHold) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    TemporaryFolder folder;
    // Eight pixels: four at 10 m in both, two that meet nothing in both, two that do in one alone; one leaf is another.
    Image depth_a(8, 1, 1), depth_b(8, 1, 1), leaf_a(8, 1, 1), leaf_b(8, 1, 1);
    depth_a.pixels = {10.5f, 10, 10, 10, kInfinity, kInfinity, kInfinity, 3};
    depth_b.pixels = {10, 10, 10, 10, kInfinity, kInfinity, 5, kInfinity};
    leaf_a.pixels = {1, 2, 3, 4, 0, 0, 70000, 0};
    leaf_b.pixels = {1, 2, 3, 4, 0, 0, 70001, 0};
    const auto save = [&](const char* file, const Image& depth, const Image& leaf) {
        save_layers(folder / file,
                    {{"", {"R", "G", "B"}, Image(8, 1, 3)}, {"depth", {"Z"}, depth}, {"leaf", {"id"}, leaf}});
    };
    save("a.exr", depth_a, leaf_a);
    save("b.exr", depth_b, leaf_b);
    const ProgramRun run = run_kokage({"compare", "a.exr", "b.exr", "--report", "r.json"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto layers = nlohmann::json::parse(read_text(folder / "r.json"))["layers"];
    EXPECT_NEAR(double(layers["depth"]["mean"]), 0.125, 1e-6) << "of the four that are finite in both";
    EXPECT_NEAR(double(layers["depth"]["max"]), 0.5, 1e-6);
    EXPECT_EQ(layers["depth"]["pixels_finite_in_one"], 2);
    EXPECT_EQ(layers["leaf"], nlohmann::json({{"differing_share", 0.125}}));
    EXPECT_NE(run.output.find("2 pixels where only one picture is finite"), std::string::npos) << run.output;
    EXPECT_EQ(layers["depth"]["pixels_finite_in_none"], 2);
    EXPECT_NE(run.output.find("2 pixels where neither picture is finite"), std::string::npos) << run.output;
    EXPECT_FALSE(layers["depth"].contains("pixels_at_horizon"));
    EXPECT_NE(run.output.find("leaf                 differs in 12.5 % of the pixels"), std::string::npos) << run.output;
}

TEST(Compare, DepthAtTheHorizonIsInNoFigure) {
    TemporaryFolder folder;
    Image depth_a(8, 1, 1), depth_b(8, 1, 1);
    depth_a.pixels = {10.5f, 10, 10, 10, 10, 2e6f, 3e8f, 10};
    depth_b.pixels = {10, 10, 10, 10, 10, 9e5f, 4e4f, 5e7f};
    for (const auto& [file, depth] : {std::pair("a.exr", &depth_a), {"b.exr", &depth_b}})
        save_layers(folder / file, {{"", {"R", "G", "B"}, Image(8, 1, 3)}, {"depth", {"Z"}, *depth}});
    const ProgramRun run = run_kokage({"compare", "a.exr", "b.exr", "--report", "r.json"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto depth = nlohmann::json::parse(read_text(folder / "r.json"))["layers"]["depth"];
    EXPECT_NEAR(double(depth["mean"]), 0.1, 1e-6) << "of the five that are near in both";
    EXPECT_EQ(depth["pixels_at_horizon"], 3);
    EXPECT_EQ(depth["pixels_finite_in_none"], 0);
    EXPECT_NE(run.output.find("3 pixels farther than 1e+03 m (the horizon), in no figure"), std::string::npos)
        << run.output;
}

TEST(Compare, ReflectionMapsOfDifferentFilesAreCompared) {
    TemporaryFolder folder;
    ShellMap shells({.kind = LobeKind::ggx, .least_parameter = 0.4, .most_parameter = 1});
    shells.set_texels(std::vector<glm::vec3>(shells.layout().size(), glm::vec3(0.5f)));
    write_map(folder / "shells.exr", shells);
    PrefilteredCube cube = empty_cube({.size = 8, .kind = LobeKind::ggx, .parameters = {0.5, 1}});
    for (PrefilteredCube::Level& level : cube.levels)
        std::fill(level.texels.begin(), level.texels.end(), glm::vec3(0.25f));
    write_ktx2(folder / "cube.ktx2", cube, TexelFormat::half_rgb);
    const ProgramRun run =
        run_kokage({"compare", "shells.exr", "cube.ktx2", "--report", "r.json", "-o", "map.png"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    const auto report = nlohmann::json::parse(read_text(folder / "r.json"));
    EXPECT_NEAR(double(report["error"]["mean_error_255"]), 0.25 * 255, 1e-3);
    EXPECT_NEAR(double(report["error"]["max_relative_error"]), 1, 1e-5);
    EXPECT_EQ(report["lobes"].size(), 2u);
    EXPECT_EQ(load_image(folder / "map.png").height, 256);
    save_image(folder / "picture.exr", grey_ramp(0));
    for (const auto& [a, b] : {std::pair{"shells.exr", "picture.exr"}, {"picture.exr", "cube.ktx2"}}) {
        const ProgramRun unlike = run_kokage({"compare", a, b}, folder.path());
        EXPECT_EQ(unlike.status, 2);
        EXPECT_TRUE(is_one_complaint(unlike.errors)) << unlike.errors;
        EXPECT_NE(unlike.errors.find("not of one kind"), std::string::npos);
    }
}

TEST(Compare, AgainstABlackReferenceRelativeErrorsAreUndefined) {
    TemporaryFolder folder;
    save_image(folder / "a.exr", grey_ramp(0));
    save_image(folder / "black.exr", Image(8, 4, 3));
    const ProgramRun pictures = run_kokage({"compare", "a.exr", "black.exr", "--report", "r.json"}, folder.path());
    ASSERT_EQ(pictures.status, 0) << pictures.errors;
    EXPECT_NE(pictures.output.find("mean relative error  undefined, B is black"), std::string::npos) << pictures.output;
    EXPECT_TRUE(nlohmann::json::parse(read_text(folder / "r.json"))["error"]["mean_relative"].is_null());
    for (const char* name : {"a", "black"})
        ASSERT_EQ(run_kokage({"bake", std::string(name) + ".exr", "--smoothness", "0,0.1", "-o",
                              std::string(name) + "-map.exr"},
                             folder.path())
                      .status,
                  0);
    const ProgramRun maps = run_kokage({"compare", "a-map.exr", "black-map.exr", "--report", "r.json"}, folder.path());
    ASSERT_EQ(maps.status, 0) << maps.errors;
    EXPECT_NE(maps.output.find("relative: undefined, B is black"), std::string::npos) << maps.output;
    EXPECT_EQ(maps.output.find("inf"), std::string::npos) << maps.output;
    const auto error = nlohmann::json::parse(read_text(folder / "r.json"))["error"];
    EXPECT_TRUE(error["max_relative_error"].is_null());
    EXPECT_NEAR(double(error["mean_error"]), 0.5, 0.02);
}

TEST(Compare, LinearAgainstDisplayColoursIsWarnedOf) {
    TemporaryFolder folder;
    save_image(folder / "a.exr", grey_ramp(0));
    save_image(folder / "b.png", grey_ramp(0));
    const ProgramRun run = run_kokage({"compare", "a.exr", "b.png", "--report", "r.json"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.errors.find("warning: 'a.exr' holds linear radiance, 'b.png' display colours of 8 bits"),
              std::string::npos)
        << run.errors;
    EXPECT_TRUE(is_one_complaint(run.errors));
    EXPECT_EQ(nlohmann::json::parse(read_text(folder / "r.json"))["warnings"].size(), 1u);
}

TEST(Compare, WhatCannotBeComparedIsSaidInOneLine) {
    TemporaryFolder folder;
    save_image(folder / "a picture.png", grey_ramp(0));
    save_image(folder / "small.png", Image(2, 2, 3));
    std::ofstream(folder / "broken.png") << "this is no picture";
    const std::vector<std::vector<std::string>> wrongs = {
        {"compare"},
        {"compare", "a picture.png"},
        {"compare", "a picture.png", "missing.png"},
        {"compare", "a picture.png", "small.png"},
        {"compare", "a picture.png", "broken.png"},
        {"compare", "a picture.png", "."},
        {"compare", "a picture.png", "a picture.png", "-o", "map"},
        {"compare", "a picture.png", "small.png", "-o", "a picture.png"},
        {"compare", "a picture.png", "a picture.png", "--report", "nowhere/r.json"}};
    for (const auto& words : wrongs) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2) << words.back();
        EXPECT_TRUE(is_one_complaint(run.errors)) << words.back();
        if (words.back() == "missing.png") {
            EXPECT_NE(run.errors.find("there is no file 'missing.png'"), std::string::npos) << run.errors;
        }
    }
    EXPECT_EQ(folder.files(), std::vector<std::string>({"a picture.png", "broken.png", "small.png"}));
}

} // namespace
} // namespace kokage

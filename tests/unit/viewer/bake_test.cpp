// `kokage bake` as a user runs it, on small images and coarse maps.
#include "common/scene/image_file.h"
#include "reflection/maps/baked_map.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/harmonics_file.h"
#include "reflection/maps/map_file.h"
#include "tests/support/program_run.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

namespace kokage {
namespace {
using Json = nlohmann::json;
using Words = std::vector<std::string>;

Image gradient_image(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = 0.2f + 0.6f * float(y + c) / float(height + 2);
    return image;
}

/// A coarse map, quickly; further words are added.
Words small_bake(const std::string& environment, Words more) {
    Words words = {"bake", environment, "--smoothness", "0,0.1"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// What is in a map of shells.
std::vector<std::byte> texels_of(const std::filesystem::path& file) {
    const MapFile map = read_map(file);
    const std::span<const std::byte> texels = std::get<ShellMap>(map.map).texels();
    return {texels.begin(), texels.end()};
}

/// The message of a run that is refused: exit status 2, one line, nothing written.
std::string refusal(const Words& words) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(16, 8));
    const ProgramRun run = run_kokage(words, folder.path());
    EXPECT_EQ(run.status, 2) << run.errors;
    EXPECT_EQ(std::count(run.errors.begin(), run.errors.end(), '\n'), 1) << run.errors;
    EXPECT_EQ(folder.files(), Words({"in.exr"}));
    return run.errors;
}

TEST(Bake, WritesAMapAndAReportAndSaysWhere) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    const ProgramRun run = run_kokage(small_bake("in.exr", {"-o", "m.exr", "--report", "r.json"}), folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.errors, "");
    EXPECT_NE(run.output.find((std::filesystem::canonical(folder.path()) / "m.exr").string()), std::string::npos);
    EXPECT_NE(run.output.find("skipped: what is rougher or smoother"), std::string::npos) << run.output;
    const MapFile file = read_map(folder / "m.exr");
    EXPECT_NE(file.made_from.find("32 x 16"), std::string::npos);
    const ShellMap& shells = std::get<ShellMap>(file.map);
    EXPECT_GT(shells.lookup({0, -1, 0}, 10).x, shells.lookup({0, 1, 0}, 10).x) << "brighter below";
    const Json report = Json::parse(read_text(folder / "r.json"));
    EXPECT_EQ(report["settings"]["method"], "spectral");
    EXPECT_EQ(report["map"]["bytes"], shells.bytes());
    EXPECT_EQ(report["inputs"]["surroundings"]["width"], 32);
    EXPECT_TRUE(std::any_of(report["skipped"].begin(), report["skipped"].end(), [](const Json& skip) {
        return skip["what"].get<std::string>().find("rougher or smoother") != std::string::npos;
    })) << report["skipped"];
    EXPECT_GT(report["stages"].size(), 2u);
}

TEST(Bake, MethodsAgreeAndContainersAreWhatTheirEndingSays) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    std::vector<glm::vec3> values;
    for (const std::string method : {"spectral", "table", "brute-force"}) {
        const ProgramRun run = run_kokage({"bake", "in.exr", "--container", "cube", "--size", "16", "--method", method,
                                           "--roughness-scale", "paper", "-o", "m.exr"},
                                          folder.path());
        ASSERT_EQ(run.status, 0) << run.errors;
        const VoxelCube cube = std::get<VoxelCube>(read_map(folder / "m.exr").map);
        EXPECT_EQ(cube.scale().u(), 6.2);
        values.push_back(cube.lookup({0, -1, 0}, 0.8f));
    }
    EXPECT_LT(glm::distance(values[0], values[2]), 2e-3f);
    EXPECT_LT(glm::distance(values[1], values[2]), 2e-2f);
    ASSERT_EQ(run_kokage({"bake", "in.exr", "--size", "32", "-o", "m.ktx2"}, folder.path()).status, 0);
    ASSERT_EQ(run_kokage({"bake", "in.exr", "--size", "32", "-o", "m.dds"}, folder.path()).status, 0);
    const PrefilteredCube cube = read_ktx2(folder / "m.ktx2").cube;
    EXPECT_EQ(cube.levels.size(), 5u);
    EXPECT_EQ(cube.kind, LobeKind::ggx);
    EXPECT_EQ(cube.levels[1].texels, read_dds(folder / "m.dds").cube.levels[1].texels);
}

TEST(Bake, TakesSkyConstantAndLights) {
    const TemporaryFolder folder;
    for (const Words& words :
         {small_bake("sky", {"--sun", "90,30", "-o", "a.exr"}), small_bake("constant:0.5", {"-o", "b.exr"}),
          small_bake("gradient", {"--light", "sun:0,45,3,2,1", "-o", "c.exr"})}) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 0) << run.errors;
    }
    const ShellMap sky = std::get<ShellMap>(read_map(folder / "a.exr").map);
    EXPECT_GT(sky.lookup(glm::normalize(glm::vec3(1, 0.57f, 0)), 20).x,
              2 * sky.lookup(glm::normalize(glm::vec3(-1, 0.57f, 0)), 20).x)
        << "the sun stands in the east";
    EXPECT_NEAR(std::get<ShellMap>(read_map(folder / "b.exr").map).lookup({0, 1, 0}, 5).y, 0.5f, 1e-3f);
}

TEST(Bake, WritesSphericalHarmonics) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    const ProgramRun run = run_kokage({"bake", "in.exr", "--light", "sun:0,45,3,2,1", "--bands", "2", "--quantity",
                                       "irradiance", "--list-lights", "-o", "h.json", "--report", "r.json"},
                                      folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.output.find("irradiance, 2 bands"), std::string::npos) << run.output;
    const HarmonicsFile file = read_harmonics(folder / "h.json");
    EXPECT_NE(file.made_from.find("32 x 16"), std::string::npos);
    EXPECT_EQ(file.harmonics.bands(), 2);
    ASSERT_EQ(file.harmonics.lights.size(), 1u);
    EXPECT_EQ(file.harmonics.lights[0].irradiance, glm::vec3(3, 2, 1));
    const glm::vec3 up = file.harmonics.value({0, 1, 0}), down = file.harmonics.value({0, -1, 0});
    EXPECT_NEAR(up.y - 2 * std::sqrt(0.5f), 1.2f, 0.15f) << "a gradient of 0.2 to 0.8, brighter below, and the light";
    EXPECT_NEAR(up.y - 2 * std::sqrt(0.5f) + down.y, 2 * kPi * (0.2f + 0.6f * 8.5f / 18), 1e-3f) << "2 pi x the mean";
    EXPECT_EQ(Json::parse(read_text(folder / "r.json"))["settings"]["bands"], 2);
}

TEST(Bake, AStoredSetupIsMadeOnceAndMapsStayTheSame) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    for (const std::string method : {"spectral", "table"}) {
        const std::filesystem::path stored = folder / (method + ".setup");
        const Words words = small_bake("in.exr", {"--method", method, "--stored", stored.string(), "-o", "m.exr"});
        ASSERT_EQ(run_kokage(words, folder.path()).status, 0) << method;
        const std::vector<std::byte> first = texels_of(folder / "m.exr");
        ASSERT_TRUE(std::filesystem::exists(stored)) << method;
        const auto written = std::filesystem::last_write_time(stored);
        ASSERT_EQ(run_kokage(words, folder.path()).status, 0) << method;
        EXPECT_EQ(std::filesystem::last_write_time(stored), written) << method << ": read, not made again";
        EXPECT_TRUE(texels_of(folder / "m.exr") == first) << method;
        std::ofstream(stored) << "something else";
        const ProgramRun refused = run_kokage(words, folder.path());
        EXPECT_EQ(refused.status, 2) << method;
        EXPECT_NE(refused.errors.find(method + ".setup"), std::string::npos) << refused.errors;
    }
}

TEST(Bake, SameBitsWithAnyNumberOfThreads) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(64, 32));
    for (const std::string method : {"spectral", "table"}) {
        for (const std::string threads : {"1", "4"})
            ASSERT_EQ(run_kokage(small_bake("in.exr", {"--method", method, "--threads", threads, "-o",
                                                       method + threads + ".exr"}),
                                 folder.path())
                          .status,
                      0);
        EXPECT_TRUE(texels_of(folder / (method + "1.exr")) == texels_of(folder / (method + "4.exr"))) << method;
    }
}

TEST(Bake, StrangeImagesGiveARightMapOrOneClearLine) {
    const TemporaryFolder folder;
    const auto bake = [&](const Image& image, const std::string& name, Words more) {
        save_image(folder / name, image);
        more.insert(more.end(), {"-o", "m.exr"});
        return run_kokage(small_bake(name, more), folder.path());
    };
    const auto value = [&](const glm::vec3& direction) {
        return std::get<ShellMap>(read_map(folder / "m.exr").map).lookup(direction, 8);
    };
    // All black, constant, one pixel, not twice as wide as high, 8 bits.
    ASSERT_EQ(bake(Image(32, 16, 3), "black.exr", {}).status, 0);
    EXPECT_EQ(value({1, 0, 0}), glm::vec3(0.f));
    Image one(1, 1, 3);
    one.pixels = {0.25f, 0.5f, 1};
    ASSERT_EQ(bake(one, "one.exr", {}).status, 0);
    EXPECT_LT(glm::distance(value({0, 0, 1}), glm::vec3(0.25f, 0.5f, 1)), 1e-3f);
    ASSERT_EQ(bake(gradient_image(1, 1), "one.png", {}).status, 0);
    const ProgramRun odd = bake(gradient_image(40, 16), "odd.exr", {});
    EXPECT_EQ(odd.status, 0);
    EXPECT_NE(odd.errors.find("not twice as wide as high"), std::string::npos) << odd.errors;
    EXPECT_EQ(bake(gradient_image(8, 16), "high.exr", {}).status, 2);
    EXPECT_EQ(bake(gradient_image(32, 16), "eight.png", {}).status, 0);
    // One pixel of 1e30: everything stays finite, and halves say that they cut it off.
    Image bright = gradient_image(32, 16);
    bright.at(9, 9)[0] = 1e30f;
    const ProgramRun huge = bake(bright, "bright.exr", {});
    EXPECT_EQ(huge.status, 0) << huge.errors;
    EXPECT_NE(huge.errors.find("--format float"), std::string::npos) << huge.errors;
    ASSERT_EQ(bake(bright, "bright.exr", {"--format", "float"}).status, 0);
    for (const glm::vec3 direction : {glm::vec3(1, 0, 0), glm::vec3(-1, 0, 0), glm::vec3(0, 0, 1), glm::vec3(0, 0, -1)})
        EXPECT_TRUE(value(direction).x >= 0 && value(direction).x < 1e31f);
    // More columns than a loader takes: reduced.
    Image wide(16384, 2, 3);
    std::fill(wide.pixels.begin(), wide.pixels.end(), 0.5f);
    wide.at(5, 0)[0] = 0.6f;
    const ProgramRun reduced = bake(wide, "wide.exr", {});
    EXPECT_EQ(reduced.status, 0);
    EXPECT_NE(reduced.output.find("16384 columns became 4096"), std::string::npos) << reduced.output;
    EXPECT_NEAR(value({0, 1, 0}).y, 0.5f, 1e-2f);
}

TEST(Bake, BadPixelsAreRepairedOrRefusedWithTheirPlace) {
    const TemporaryFolder folder;
    // save_image refuses NaN; negative values pass.
    Image spoilt = gradient_image(32, 16);
    spoilt.at(7, 8)[2] = -3;
    save_image(folder / "in.exr", spoilt);
    const ProgramRun repaired = run_kokage(small_bake("in.exr", {"-o", "m.exr"}), folder.path());
    EXPECT_EQ(repaired.status, 0);
    EXPECT_NE(repaired.errors.find("pixel (7, 8)"), std::string::npos) << repaired.errors;
    const ProgramRun refused = run_kokage(small_bake("in.exr", {"--strict", "-o", "n.exr"}), folder.path());
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.errors.find("(7, 8)"), std::string::npos) << refused.errors;
}

TEST(Bake, WhatCantBeIsRefusedInOneLine) {
    const std::pair<Words, const char*> cases[] = {
        {{"none.exr", "-o", "m.exr"}, "there is no file 'none.exr'"},
        {{"in.exr", "-o", "m.png"}, "the ending .png is not known"},
        {{"in.exr", "-o", "nowhere/m.exr"}, "nowhere"},
        {{"in.exr", "-o", "in.exr"}, "named twice"},
        {{"in.exr", "--container", "cube", "-o", "m.ktx2"}, "--container"},
        {{"in.exr", "--container", "ball", "-o", "m.exr"}, "shells or cube"},
        {{"in.exr", "--lobe", "ward", "-o", "m.exr"}, "phong or ggx"},
        {{"in.exr", "--method", "magic", "-o", "m.exr"}, "spectral, table, brute-force"},
        {{"in.exr", "--size", "64", "-o", "m.exr"}, "--size"},
        {{"in.exr", "--size", "0", "-o", "m.ktx2"}, "--size"},
        {{"in.exr", "--size", "17", "--container", "cube", "-o", "m.exr"}, "17"},
        {{"in.exr", "--size", "48", "-o", "m.ktx2"}, "power of two"},
        {{"in.exr", "--levels", "3", "-o", "m.exr"}, "--levels"},
        {{"in.exr", "--levels", "30", "-o", "m.ktx2"}, "levels"},
        {{"in.exr", "--smoothness", "0.6,0.3", "-o", "m.exr"}, "rough first"},
        {{"in.exr", "--smoothness", "0.6", "-o", "m.exr"}, "rough first"},
        {{"in.exr", "--smoothness", "a,b", "-o", "m.exr"}, "--smoothness"},
        {{"in.exr", "--roughness-scale", "paper", "-o", "m.exr"}, "--container cube"},
        {{"in.exr", "--roughness-scale", "paper", "--lobe", "ggx", "--container", "cube", "-o", "m.exr"},
         "--lobe phong"},
        {{"in.exr", "--bands", "3", "-o", "m.exr"}, "write a .json"},
        {{"in.exr", "--size", "64", "-o", "m.json"}, "maps of texels"},
        {{"in.exr", "--bands", "600", "-o", "m.json"}, "from 1 to 512"},
        {{"in.exr", "--quantity", "light", "-o", "m.json"}, "radiance, irradiance"},
        {{"in.exr", "--roughness", "0.6,0.3", "-o", "m.exr"}, "smooth first"},
        {{"in.exr", "--roughness", "0.3,1.1", "-o", "m.exr"}, "smooth first"},
        {{"in.exr", "--roughness", "0.3,0.6", "--smoothness", "0,0.1", "-o", "m.exr"}, "leave one of them out"},
        {{"in.exr", "--roughness", "0,0.6", "-o", "m.exr"}, "only cube maps"},
        {{"in.exr", "--roughness", "0.02,0.6", "-o", "m.exr"}, "roughness 0.03"},
        {{"in.exr", "--roughness", "0.05,0.6", "--container", "cube", "-o", "m.exr"}, "roughness 0.089"},
        {{"in.exr", "--smoothness", "0.3,0.3", "--levels", "3", "-o", "m.ktx2"}, "would all be alike"},
        {{"in.exr", "--levels", "9", "-o", "m.dds"}, "8 levels, not of 9"},
        {{"in.exr", "--size", "16384", "--format", "float", "-o", "m.ktx2"}, "more than 16 GB"},
        {{"in.exr", "--tolerance", "1e-9", "-o", "m.exr"}, "--tolerance"},
        {{"in.exr", "--tolerance", "nan", "-o", "m.exr"}, "--tolerance"},
        {{"in.exr", "--tolerance", "0.01", "--method", "table", "-o", "m.exr"}, "can't aim at an error"},
        {{"in.exr", "--threshold", "0.01", "-o", "m.exr"}, "--method table"},
        {{"in.exr", "--threshold", "0.5", "--method", "table", "-o", "m.exr"}, "below 0.3"},
        {{"in.exr", "--weights", "new", "--method", "table", "-o", "m.exr"}, "matched, renormalised, paper"},
        {{"in.exr", "--stored", "x", "--method", "brute-force", "-o", "m.exr"}, "--stored"},
        {{"in.exr", "--format", "byte", "-o", "m.exr"}, "shared-exponent"},
        {{"in.exr", "--format", "shared-exponent", "-o", "m.dds"}, "--format"},
        {{"in.exr", "--light", "point:0,1,0,1,1,1", "-o", "m.exr"}, "infinitely far"},
        {{"in.exr", "--sun", "10,10", "-o", "m.exr"}, "--sun"},
        {{"in.exr", "-o", "m_%03d.exr"}, "one environment"},
        {{"in_%d.exr", "-o", "m_%d.exr"}, "names no images"},
        {{".", "-o", "m.exr"}, "no place for the frames' numbers"},
        {{".", "--broken-frames", "hide", "-o", "m_%d.exr"}, "skip or stop"},
        {{"in.exr", "-o", "m.exr", "--report", "r.txt"}, "r.txt"},
        {{"in.exr", "--compression", "lzma", "-o", "m.exr"}, "zip, rle or none"},
        {{"in.exr", "--compression", "none", "-o", "m.ktx2"}, "only .exr"},
    };
    for (const auto& [words, expected] : cases) {
        Words all = {"bake"};
        all.insert(all.end(), words.begin(), words.end());
        const std::string message = refusal(all);
        EXPECT_NE(message.find(expected), std::string::npos) << expected << "\n" << message;
    }
}

TEST(Bake, ARangeOfTheCubeIsInItsFileAndLookupsOutsideGiveItsEnds) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    const ProgramRun run = run_kokage({"bake", "in.exr", "--container", "cube", "--size", "32", "--smoothness",
                                       "0.3,0.6", "-o", "m.exr", "--report", "r.json"},
                                      folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.output.find("smoothness 0.3 to 0.6, 22 voxels along an edge"), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("of CPU, at the same cost a texel"), std::string::npos) << run.output;
    const VoxelCube cube = std::get<VoxelCube>(read_map(folder / "m.exr").map);
    EXPECT_EQ(cube.range().smoothest, 0.6);
    for (const glm::vec3 direction : {glm::vec3(0, 1, 0), glm::vec3(0.6f, -0.8f, 0)}) {
        EXPECT_GT(cube.lookup(direction, 0).x, 0.1f);
        EXPECT_EQ(cube.lookup(direction, 0), cube.lookup(direction, 0.3f));
        EXPECT_EQ(cube.lookup(direction, 1), cube.lookup(direction, 0.6f));
    }
    const Json report = Json::parse(read_text(folder / "r.json"));
    EXPECT_EQ(report["map"]["size"], 22);
    EXPECT_EQ(report["map"]["smoothness"], Json({0.3, 0.6}));
    EXPECT_EQ(report["map"]["filtered_texels"], cube.layout().size());
    EXPECT_EQ(report["map"]["bytes"], 22 * 22 * 22 * 6);
    // Compared at lobes that both hold.
    ASSERT_EQ(run_kokage({"bake", "in.exr", "-o", "whole.exr"}, folder.path()).status, 0);
    const ProgramRun compared = run_kokage({"compare", "m.exr", "whole.exr", "--report", "c.json"}, folder.path());
    ASSERT_EQ(compared.status, 0) << compared.errors;
    const Json c = Json::parse(read_text(folder / "c.json"));
    const RoughnessScale scale = RoughnessScale::solved(32);
    EXPECT_NEAR(c["lobes"].front()["parameter"], scale.exponent(0.3), 1e-3);
    EXPECT_NEAR(c["lobes"].back()["parameter"], scale.exponent(0.6), 1e-3);
    EXPECT_LT(c["error"]["max_error_255"], 8);
}

TEST(Bake, LevelsAreToldWithTheirRoughness) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    const ProgramRun run =
        run_kokage({"bake", "in.exr", "--size", "16", "--roughness", "0,0.4", "-o", "m.ktx2", "--report", "r.json"},
                   folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.output.find("level 0: the image itself, 16 texels along an edge"), std::string::npos) << run.output;
    EXPECT_NE(run.output.find("level 3: roughness 0.3, 2 texels along an edge"), std::string::npos) << run.output;
    const Json levels = Json::parse(read_text(folder / "r.json"))["map"]["levels"];
    const PrefilteredCube cube = read_ktx2(folder / "m.ktx2").cube;
    ASSERT_EQ(levels.size(), 5u);
    ASSERT_EQ(cube.levels.size(), 5u);
    EXPECT_TRUE(levels[0]["is_the_image"]);
    EXPECT_TRUE(levels[0]["exponent"].is_null());
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_NEAR(levels[i]["roughness"], 0.1 * double(i), 1e-12);
        EXPECT_NEAR(cube.levels[i].parameter, 0.1 * double(i), 1e-12);
        EXPECT_EQ(levels[i]["size"], cube.levels[i].size);
    }
    const ProgramRun odd = run_kokage({"bake", "in.exr", "--size", "7", "-o", "m.ktx2"}, folder.path());
    EXPECT_EQ(odd.status, 0);
    EXPECT_NE(odd.errors.find("nothing filtered"), std::string::npos) << odd.errors;
}

TEST(Bake, AToleranceThatTheFormatCantKeepIsSaid) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    const auto errors = [&](Words more) {
        const ProgramRun run = run_kokage(small_bake("in.exr", std::move(more)), folder.path());
        EXPECT_EQ(run.status, 0);
        return run.errors;
    };
    EXPECT_NE(errors({"--tolerance", "1e-4", "-o", "m.exr"}).find("half rounds by up to 0.00049"), std::string::npos);
    EXPECT_EQ(errors({"--tolerance", "1e-4", "--format", "float", "-o", "m.exr"}), "");
    EXPECT_EQ(errors({"--tolerance", "1e-3", "-o", "m.exr"}), "");
    EXPECT_EQ(errors({"-o", "m.exr"}), "");
}

TEST(Bake, WhatMemoryCantHoldIsRefusedBeforeAnyWork) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(16, 8));
    const std::pair<Words, const char*> cases[] = {
        {{"bake", "in.exr", "--container", "cube", "--size", "1022", "-o", "m.exr"}, "; --size "},
        {{"bake", "in.exr", "--size", "16384", "-o", "m.ktx2"}, "; --size "},
        {{"bake", "in.exr", "--detail", "16", "-o", "m.exr"}, "; --detail "},
    };
    for (const auto& [words, mend] : cases) {
        const ProgramRun run = run_kokage(words, folder.path(), {.address_space = std::uint64_t(3) << 30});
        EXPECT_EQ(run.status, 2);
        EXPECT_TRUE(is_one_complaint(run.errors)) << run.errors;
        EXPECT_NE(run.errors.find("of memory, and 2."), std::string::npos) << run.errors;
        EXPECT_NE(run.errors.find(mend), std::string::npos) << run.errors;
        EXPECT_EQ(folder.files(), Words({"in.exr"}));
    }
}

TEST(Bake, WithoutMemoryItEndsInOneLineAndWithoutAFile) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(64, 32));
    bool failed = false, worked = false;
    for (const std::uint64_t megabytes : {500, 650, 800, 4000}) { // from not even for tables to enough
        const ProgramRun run = run_kokage({"bake", "in.exr", "--container", "cube", "--threads", "2", "-o", "m.exr"},
                                          folder.path(), {.address_space = megabytes << 20});
        (run.status == 0 ? worked : failed) = true;
        if (run.status != 0) {
            EXPECT_EQ(run.status, 2) << megabytes << " " << run.errors;
            EXPECT_TRUE(is_one_complaint(run.errors)) << run.errors;
            EXPECT_NE(run.errors.find("memory"), std::string::npos) << run.errors;
            EXPECT_EQ(folder.files(), Words({"in.exr"}));
        }
    }
    EXPECT_TRUE(failed && worked);
}

TEST(Bake, TheMemoryThatItTakesIsWhatWasPlanned) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(32, 16));
    const auto peak = [&](Words words) {
        words.insert(words.begin(), {"bake", "in.exr"});
        words.insert(words.end(), {"--report", "r.json"});
        EXPECT_EQ(run_kokage(words, folder.path()).status, 0);
        return double(Json::parse(read_text(folder / "r.json"))["peak_memory_bytes"]);
    };
    MapSettings settings;
    settings.container = MapContainer::voxel_cube;
    settings.size = 160;
    const double small = peak({"--container", "cube", "--size", "16", "-o", "m.exr"});
    const double large = peak({"--container", "cube", "--size", "160", "-o", "m.exr"});
    EXPECT_NEAR((large - small) / double(plan_map(settings).peak_bytes), 1, 0.25);
    settings.container = MapContainer::cube_map;
    settings.lobe = LobeKind::ggx;
    settings.size = 1024;
    EXPECT_NEAR((peak({"--size", "1024", "-o", "m.ktx2"}) - small) / double(plan_map(settings).peak_bytes), 1, 0.25);
}

TEST(Bake, AMapIsNoImageOfSurroundings) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(16, 8));
    ASSERT_EQ(run_kokage(small_bake("in.exr", {"-o", "m.exr"}), folder.path()).status, 0);
    const ProgramRun run = run_kokage(small_bake("m.exr", {"-o", "again.exr"}), folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_NE(run.errors.find("'m.exr' is a reflection map"), std::string::npos) << run.errors;
    const ProgramRun video = run_kokage(small_bake(".", {"-o", "maps%03d.ktx2"}), folder.path());
    EXPECT_EQ(video.status, 2) << "maps would lie among the frames";
    std::ofstream(folder / "list.txt") << "in.exr\nm.exr\n";
    const ProgramRun list = run_kokage(small_bake("list.txt", {"-o", "%03d.ktx2"}), folder.path());
    EXPECT_NE(list.errors.find("frame 2 is broken and left out: 'm.exr' is a reflection map"), std::string::npos)
        << list.errors;
}

TEST(Bake, TheSameMapIsTheSameBytesWheneverItIsWritten) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(16, 8));
    ASSERT_EQ(run_kokage(small_bake("in.exr", {"-o", "m.exr"}), folder.path()).status, 0);
    const std::regex time("\\d{4}:\\d\\d:\\d\\d \\d\\d:\\d\\d:\\d\\d");
    EXPECT_FALSE(std::regex_search(read_text(folder / "m.exr").substr(0, 2000), time));
}

TEST(Bake, CtrlCLeavesNoHalfFile) {
    const TemporaryFolder folder;
    save_image(folder / "in.exr", gradient_image(512, 256));
    const ProgramRun run = run_kokage({"bake", "in.exr", "--method", "brute-force", "--container", "cube", "--lobe",
                                       "ggx", "--size", "256", "-o", "m.exr"},
                                      folder.path(), {.interrupt_after_seconds = 2.5});
    EXPECT_EQ(run.status, 130) << run.errors;
    EXPECT_NE(run.errors.find("stopped; nothing was written"), std::string::npos) << run.errors;
    EXPECT_EQ(folder.files(), Words({"in.exr"}));
}

TEST(Bake, AVideoNamesItsBrokenFramesAndGoesOnWhereItStopped) {
    const TemporaryFolder folder;
    for (int i : {1, 2, 4})
        save_image(folder / ("f" + std::to_string(i) + ".hdr"), gradient_image(16, 8));
    std::ofstream(folder / "f3.hdr") << "not a picture";
    const Words words = {"bake", "f%d.hdr", "--container",   "cube",     "--size",
                         "16",   "-o",      "maps/%02d.exr", "--report", "r.json"};
    const ProgramRun run = run_kokage(words, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.errors.find("frame 3 is broken and left out"), std::string::npos) << run.errors;
    EXPECT_NE(run.output.find("3 frames baked"), std::string::npos) << run.output;
    EXPECT_TRUE(std::filesystem::exists(folder / "maps" / "04.exr"));
    const ProgramRun quiet = run_kokage(
        {"bake", "f%d.hdr", "--container", "cube", "--size", "16", "-o", "quiet/%02d.exr", "--quiet"}, folder.path());
    EXPECT_EQ(quiet.output, "");
    EXPECT_NE(quiet.errors.find("frame 3 is broken and left out"), std::string::npos) << quiet.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "maps" / "03.exr"));
    const Json report = Json::parse(read_text(folder / "r.json"));
    EXPECT_EQ(report["sequence"]["baked"], 3);
    EXPECT_EQ(report["sequence"]["first_broken"][0]["frame"], 3);
    save_image(folder / "f3.hdr", gradient_image(16, 8));
    const ProgramRun again = run_kokage(words, folder.path());
    EXPECT_NE(again.output.find("1 frame baked"), std::string::npos) << again.output;
    EXPECT_NE(again.output.find("3 kept from before"), std::string::npos) << again.output;
    Words other = words;
    other[5] = "32";
    const ProgramRun refused = run_kokage(other, folder.path());
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.errors.find("another size (16, not 32)"), std::string::npos) << refused.errors;
    std::ofstream(folder / "f2.hdr") << "not a picture";
    Words stopping = words;
    stopping.insert(stopping.end(), {"--broken-frames", "stop"});
    const ProgramRun stopped = run_kokage(stopping, folder.path());
    EXPECT_EQ(stopped.status, 2);
    EXPECT_NE(stopped.errors.find("frame 2 is broken"), std::string::npos) << stopped.errors;
    EXPECT_FALSE(std::filesystem::exists(folder / "maps" / "02.exr")) << "it was of another image";
    EXPECT_TRUE(std::filesystem::exists(folder / "maps" / "02.exr.outdated"));
    EXPECT_NE(stopped.errors.find("02.exr.outdated"), std::string::npos) << stopped.errors;
}

TEST(Bake, TheMemoryOfAVideoDoesNotGrowWithItsLength) {
    const TemporaryFolder folder;
    const Image image = gradient_image(512, 256); // 1.6 MB
    save_image(folder / "image.exr", image);
    const auto peak = [&](const std::string& name, int frames) {
        std::ofstream list(folder / (name + ".txt"));
        for (int i = 0; i < frames; ++i)
            list << "image.exr\n";
        list.close();
        const ProgramRun run = run_kokage({"bake", name + ".txt", "--container", "cube", "--size", "16", "--method",
                                           "table", "-o", name + "/%d.exr", "--report", name + ".json"},
                                          folder.path());
        EXPECT_EQ(run.status, 0) << run.errors;
        const Json report = Json::parse(read_text(folder / (name + ".json")));
        EXPECT_EQ(report["sequence"]["baked"], frames);
        EXPECT_GT(report["sequence"]["frames_per_second"], 0);
        for (const char* step : {"reading", "baking", "writing"})
            EXPECT_GT(report["sequence"]["cpu_seconds_a_frame"][step], 0) << step;
        return report["peak_memory_bytes"].get<double>();
    };
    const double few = peak("few", 10), many = peak("many", 40);
    EXPECT_LT(many, few + 10 * 1.6e6) << "30 more images alone would be 47 MB";
}

} // namespace
} // namespace kokage

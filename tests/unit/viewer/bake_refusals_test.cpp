// `kokage bake` on strange and bad input: one clear line, or a right map.
#include "common/scene/image_file.h"
#include "tests/unit/viewer/bake_runs.h"

#include <fstream>

namespace kokage {
namespace {

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

} // namespace
} // namespace kokage

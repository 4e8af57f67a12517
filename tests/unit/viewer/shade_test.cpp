// `kokage shade` as a user runs it, on small trees.
#include "common/scene/image_file.h"
#include "tests/support/program_run.h"
#include "tests/unit/viewer/words.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::json;

const Words kSmallShade = {"shade", "oak", "--leaves", "200"},
            kSmallPicture = {"--image-size", "48x32", "--samples", "1"};

/// A small oak, quickly, with a picture; further words are added.
Words small_shade(const Words& more) {
    return joined(joined(kSmallShade, kSmallPicture), more);
}

Json report_of(const TemporaryFolder& folder, const Words& more) {
    const bool draws = std::find(more.begin(), more.end(), "--image") != more.end();
    const Words words = joined(draws ? small_shade(more) : joined(kSmallShade, more), {"--report", "r.json"});
    const ProgramRun run = run_kokage(words, folder.path());
    EXPECT_EQ(run.status, 0) << run.errors;
    return run.status == 0 ? Json::parse(read_text(folder / "r.json")) : Json();
}

TEST(Shade, WritesTreePictureAndReportAndSaysWhere) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage(small_shade({}), folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.errors, "");
    EXPECT_EQ(folder.files(), Words({"oak.glb", "oak.json", "oak.png"}));
    for (const char* name : {"oak.glb", "oak.json", "oak.png"})
        EXPECT_NE(run.output.find((std::filesystem::canonical(folder.path()) / name).string()), std::string::npos)
            << run.output;
    for (const char* stage : {"grow", "environment", "patches", "transport", "solve", "picture", "write"})
        EXPECT_NE(run.output.find(std::string("\n  ") + stage + " "), std::string::npos) << stage;
    EXPECT_EQ(read_text(folder / "oak.glb").substr(0, 4), "glTF");
    const Image picture = load_image(folder / "oak.png");
    EXPECT_EQ(picture.width, 48);
    EXPECT_EQ(picture.height, 32);
    EXPECT_GT(*std::max_element(picture.pixels.begin(), picture.pixels.end()), 0.1f);
}

TEST(Shade, ReportHoldsWhatItPromises) {
    TemporaryFolder folder;
    const Json r = report_of(folder, {"--seed", "3"});
    EXPECT_EQ(r["inputs"]["arguments"]["--seed"], "3");
    EXPECT_EQ(r["inputs"]["tree"]["source"], "grown: oak, seed 1");
    EXPECT_EQ(r["inputs"]["environment"]["lights"][0]["name"], "sun");
    EXPECT_EQ(r["inputs"]["ground"]["height_m"], 0);
    EXPECT_EQ(r["method"]["name"], "bundles");
    EXPECT_EQ(r["method"]["asked_error"], 0.05);
    EXPECT_EQ(r["method"]["seed"], 3);
    EXPECT_EQ(r["counts"]["leaves"], 200);
    EXPECT_GT(r["counts"]["patches"], 200);
    ASSERT_GE(r["stages"].size(), 5u);
    double stages = 0;
    for (const Json& stage : r["stages"]) {
        EXPECT_GE(stage["wall_seconds"], 0);
        stages += double(stage["cpu_seconds"]);
    }
    EXPECT_GT(stages, 0);
    EXPECT_LE(stages, double(r["cpu_seconds"]) + 0.01);
    EXPECT_GT(r["peak_memory_bytes"], 1e6);
    EXPECT_GT(r["energy"]["in"], 0);
    EXPECT_NEAR(double(r["energy"]["balance"]), 1, 0.1);
    EXPECT_GT(r["estimated_error"], 0);
    EXPECT_LT(r["estimated_error"], 0.15);
    for (const char* key : {"residuals", "skipped", "warnings", "method_stages"})
        EXPECT_TRUE(r[key].is_array()) << key;
    EXPECT_EQ(r["outputs"]["report"], "r.json");
    EXPECT_EQ(folder.files(), Words({"r.json"})) << "only what was named is written";
}

TEST(Shade, EveryMethodShades) {
    TemporaryFolder folder;
    for (const char* method : {"paper", "light-maps", "bundles", "path-traced"}) {
        const Json r = report_of(folder, {"--method", method});
        EXPECT_EQ(r["method"]["name"], method);
        EXPECT_EQ(r["method"]["asked_name"], method);
        EXPECT_GT(r["energy"]["in"], 0);
    }
}

TEST(Shade, WritesLevelsOfDetailWithTheirErrors) {
    const TemporaryFolder folder;
    const ProgramRun run =
        run_kokage({"shade", "oak", "--leaves", "800", "--effort", "8", "--lods", "levels"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    for (const char* name : {"oak_lod0.glb", "oak_lod1.glb", "oak_lod2.glb", "oak_lod3.glb", "oak_impostor.glb",
                             "oak_lods.png", "oak_lods.json"}) {
        EXPECT_TRUE(std::filesystem::is_regular_file(folder / "levels" / name)) << name;
        EXPECT_NE(run.output.find(name), std::string::npos) << name;
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "oak.glb")) << "what was not asked for";
    const Json levels = Json::parse(read_text(folder / "levels" / "oak_lods.json")).at("levels");
    ASSERT_EQ(levels.size(), 5u);
    EXPECT_EQ(levels[0]["image_mre"], 0.0) << "the full tree is the reference";
    for (const Json& row : levels) { // every error is on the terminal too
        const std::size_t line = run.output.find("  " + row["file"].get<std::string>());
        ASSERT_NE(line, std::string::npos) << run.output;
        const std::string text = run.output.substr(line, run.output.find('\n', line) - line);
        EXPECT_NE(text.find(" " + std::to_string(row["triangles"].get<int>()) + " triangles"), std::string::npos)
            << text;
        for (const char* error : {"image_mre", "image_mre_from_afar"}) {
            char percent[32];
            std::snprintf(percent, sizeof percent, "%.1f %%", 100 * row[error].get<double>());
            EXPECT_NE(text.find(percent), std::string::npos) << text;
        }
    }
    for (int level = 1; level <= 3; ++level) {
        const Json& row = levels[std::size_t(level)];
        EXPECT_NEAR(row["leaf_area_m2"].get<double>() / levels[0]["leaf_area_m2"].get<double>(), 1, 0.01);
        EXPECT_NEAR(row["mean_leaf_radiance"].get<double>() / levels[0]["mean_leaf_radiance"].get<double>(), 1, 0.01);
        EXPECT_GT(row["image_mre"].get<double>(), 0);
        EXPECT_LT(row["triangles"], levels[std::size_t(level) - 1]["triangles"]);
    }
    EXPECT_LT(levels[4]["triangles"], 20);
    // A file in the folder's place is found before the work.
    const ProgramRun refused = run_kokage({"shade", "oak", "--lods", "levels/oak_lods.png"}, folder.path());
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.errors.find("--lods"), std::string::npos) << refused.errors;
}

TEST(Shade, FilesAreShadedUnderANewNameAndAreTheSameTree) {
    TemporaryFolder folder;
    ASSERT_EQ(run_kokage({"grow", "--leaves", "200", "-o", "an oak.glb", "--quiet"}, folder.path()).status, 0);
    const std::string before = read_text(folder / "an oak.glb");
    const ProgramRun run =
        run_kokage({"shade", "an oak.glb", "--image-size", "16x16", "--samples", "1", "--quiet"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.output + run.errors, "");
    EXPECT_EQ(folder.files(), Words({"an oak-shaded.glb", "an oak-shaded.json", "an oak-shaded.png", "an oak.glb"}));
    EXPECT_EQ(read_text(folder / "an oak.glb"), before);

    // Grown here or loaded: the same tree, so the same light, but for the leaf texture's mean, which 8 bits round.
    ASSERT_EQ(run_kokage(small_shade({"-o", "grown.glb", "--quiet"}), folder.path()).status, 0);
    const ProgramRun same =
        run_kokage({"compare", "an oak-shaded.glb", "grown.glb", "--report", "c.json"}, folder.path());
    ASSERT_EQ(same.status, 0) << same.errors;
    EXPECT_LT(Json::parse(read_text(folder / "c.json"))["mre"], 1e-3);
}

TEST(Shade, ResultsAreTheSameBitsForAnyNumberOfThreads) {
    TemporaryFolder folder;
    Words trees;
    std::vector<std::vector<float>> pictures;
    for (const char* threads : {"1", "2", "5"}) {
        ASSERT_EQ(
            run_kokage(small_shade({"-o", "t.glb", "--image", "t.exr", "--threads", threads}), folder.path()).status,
            0);
        trees.push_back(read_text(folder / "t.glb"));
        pictures.push_back(load_image(folder / "t.exr").pixels); // the file holds the time of writing too
    }
    EXPECT_TRUE(trees[0] == trees[1] && trees[0] == trees[2]);
    EXPECT_TRUE(pictures[0] == pictures[1] && pictures[0] == pictures[2]);
}

TEST(Shade, SurroundingsAndMaterialsAreWhatTheUserSays) {
    TemporaryFolder folder;
    Json r = report_of(folder, {"--environment", "constant:0.5", "--light", "point:0,3,0,5", "--light",
                                "directional:90,30,1,2,3", "--leaf-reflectance", "0.5", "--leaf-transmittance",
                                "0.4,0.3,0.2", "--bark-albedo", "0"});
    EXPECT_EQ(r["inputs"]["environment"]["lights"].size(), 2u);
    EXPECT_FALSE(r["inputs"].contains("ground")) << "a constant environment lights from below";
    for (const Json& optics : r["inputs"]["optics"]) {
        const bool leaf = optics["kind"] == "leaf";
        EXPECT_NEAR(double(optics["reflectance"][1]), leaf ? 0.5 : 0, 1e-6);
        EXPECT_NEAR(double(optics["transmittance"][2]), leaf ? 0.2 : 0, 1e-6);
    }
    r = report_of(folder, {"--environment", "gradient", "--ground-albedo", "0.3"});
    EXPECT_NEAR(double(r["inputs"]["ground"]["albedo"][2]), 0.3, 1e-6);
    r = report_of(folder, {"--sun", "10,20", "--no-ground"});
    EXPECT_NEAR(double(r["inputs"]["environment"]["lights"][0]["direction"][1]), std::sin(20 * 3.14159265 / 180), 1e-6);
    EXPECT_FALSE(r["inputs"].contains("ground"));
}

TEST(Shade, BadPixelsAreCountedOrRefused) {
    TemporaryFolder folder;
    Image sky(16, 8, 3);
    std::fill(sky.pixels.begin(), sky.pixels.end(), 1.f);
    sky.at(3, 2)[0] = -1;
    save_image(folder / "my sky.exr", sky);
    const Json r = report_of(folder, {"--environment", "my sky.exr"});
    EXPECT_EQ(r["inputs"]["environment"]["bad_pixels"]["negative"], 1);
    EXPECT_EQ(r["inputs"]["environment"]["bad_pixels"]["first"], Json::array({3, 2}));
    const ProgramRun run = run_kokage(small_shade({"--environment", "my sky.exr", "--strict"}), folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(is_one_complaint(run.errors));
}

Json warnings_of(const TemporaryFolder& folder, const Words& more) {
    return report_of(folder, more)["warnings"];
}

TEST(Shade, SaysWhichOptionsChangeNothing) {
    TemporaryFolder folder;
    const Json warnings = warnings_of(folder, {"--samples", "3", "--exposure", "1", "--strict"});
    ASSERT_EQ(warnings.size(), 3u) << warnings;
    EXPECT_EQ(warnings[0], "--samples changes nothing here: no picture is drawn (--image PIC.png draws one)");
    EXPECT_NE(std::string(warnings[1]).find("--exposure changes nothing"), std::string::npos) << warnings;
    EXPECT_NE(std::string(warnings[2]).find("--strict changes nothing"), std::string::npos) << warnings;
    EXPECT_TRUE(warnings_of(folder, {"--exposure", "1", "--image", "oak.png"}).empty());
}

TEST(Shade, SaysThatPathsWereTracedInsteadOfBundles) {
    TemporaryFolder folder;
    const Json r = report_of(folder, {"--error", "0.004"});
    EXPECT_EQ(r["method"]["name"], "path-traced");
    EXPECT_EQ(r["method"]["asked_name"], "bundles");
}

TEST(Shade, OddlyShapedEnvironmentsAreWarnedOfOrRefused) {
    TemporaryFolder folder;
    Image sky(16, 8, 3);
    std::fill(sky.pixels.begin(), sky.pixels.end(), 1.f);
    save_image(folder / "panorama.exr", sky);
    sky.width = 8, sky.height = 16;
    save_image(folder / "portrait.exr", sky);
    sky = Image(12, 12, 3);
    std::fill(sky.pixels.begin(), sky.pixels.end(), 1.f);
    save_image(folder / "square.exr", sky);
    EXPECT_TRUE(warnings_of(folder, {"--environment", "panorama.exr"}).empty());
    const Json warnings = warnings_of(folder, {"--environment", "square.exr"});
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(std::string(warnings[0]).find("12 x 12, not twice as wide as high"), std::string::npos) << warnings[0];
    const ProgramRun run = run_kokage(small_shade({"--environment", "portrait.exr"}), folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(is_one_complaint(run.errors));
    EXPECT_NE(run.errors.find("8 x 16 pixels are higher than wide"), std::string::npos) << run.errors;
}

TEST(Shade, LightsThatTheGroundHidesAreLeftOutAndSaid) {
    TemporaryFolder folder;
    const Words below = {"--light", "point:1,-2,1,5", "--light", "directional:10,-20,4"};
    Words words = below;
    words.insert(words.end(), {"--method", "bundles"});
    const Json plain = report_of(folder, {}), hidden = report_of(folder, words);
    ASSERT_EQ(hidden["warnings"].size(), 2u) << hidden["warnings"];
    EXPECT_NE(std::string(hidden["warnings"][0]).find("'directional:10,-20,4' is below the horizon"),
              std::string::npos);
    EXPECT_NE(std::string(hidden["warnings"][1]).find("'point:1,-2,1,5' is under the ground"), std::string::npos);
    EXPECT_EQ(hidden["inputs"]["environment"]["description"], plain["inputs"]["environment"]["description"]);
    EXPECT_EQ(hidden["energy"], plain["energy"]) << "they light nothing";
    EXPECT_EQ(hidden["inputs"]["environment"]["lights"], plain["inputs"]["environment"]["lights"]);
    words.push_back("--no-ground");
    const Json from_below = report_of(folder, words);
    EXPECT_TRUE(from_below["warnings"].empty()) << from_below["warnings"];
    EXPECT_EQ(from_below["inputs"]["environment"]["lights"].size(), 3u);
}

TEST(Shade, DarknessIsWarnedOf) {
    TemporaryFolder folder;
    for (const char* method : {"paper", "light-maps", "bundles", "path-traced"}) {
        const Json warnings = warnings_of(folder, {"--environment", "constant:0", "--method", method});
        ASSERT_EQ(warnings.size(), 1u) << method << warnings;
        EXPECT_NE(std::string(warnings[0]).find("no light reaches the tree"), std::string::npos);
    }
    const ProgramRun run =
        run_kokage(small_shade({"--environment", "constant:0", "--report", "r.json"}), folder.path());
    EXPECT_NE(run.errors.find("kokage: warning: no light reaches the tree"), std::string::npos) << run.errors;
    EXPECT_TRUE(
        warnings_of(folder, {"--environment", "constant:0", "--light", "point:0,5,0,1", "--effort", "16"}).empty());
}

TEST(Shade, ASunThatHasSetIsWarnedOf) {
    TemporaryFolder folder;
    for (const Words& more : {Words{"--effort", "40", "--sun", "90,-10"},
                              Words{"--effort", "40", "--sun", "90,-10", "--light", "point:0,5,0,1"}}) {
        const Json warnings = warnings_of(folder, more);
        ASSERT_EQ(warnings.size(), 1u) << warnings;
        EXPECT_NE(std::string(warnings[0]).find("no night sky"), std::string::npos);
    }
    EXPECT_TRUE(warnings_of(folder, {"--sun", "90,1"}).empty());
    EXPECT_NE(run_kokage({"shade", "--help"}, folder.path()).output.find("Below the horizon"), std::string::npos);
}

TEST(Shade, SummaryNamesAddedLightsAndCountsInGoodEnglish) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage({"shade", "--leaves", "1", "--light", "point:0,5,0,1", "--light",
                                       "sun:0,50,3,3,3", "--bounces", "1", "--report", "r.json"},
                                      folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.output.rfind("oak: 1 leaf, ", 0), 0u) << run.output;
    EXPECT_NE(run.output.find("with the lights point:0,5,0,1 + sun:0,50,3,3,3\n"), std::string::npos) << run.output;
    EXPECT_NE(run.output.find(", 2 sweeps, "), std::string::npos) << run.output;
}

TEST(Shade, AShadedFileIsKnownAsOne) {
    TemporaryFolder folder;
    ASSERT_EQ(run_kokage({"grow", "--leaves", "50", "-o", "bare.glb", "--quiet"}, folder.path()).status, 0);
    const auto shade = [&](const char* from, const char* to) {
        return run_kokage({"shade", from, "-o", to}, folder.path());
    };
    const auto description = [&](const char* file) { return run_kokage({"describe", file}, folder.path()).output; };
    EXPECT_EQ(shade("bare.glb", "once.glb").output.find("shaded before"), std::string::npos);
    EXPECT_NE(shade("once.glb", "twice.glb").output.find("shaded before"), std::string::npos);
    EXPECT_EQ(description("bare.glb").find("shaded already"), std::string::npos);
    EXPECT_NE(description("once.glb").find("shaded already"), std::string::npos);
    EXPECT_EQ(description("once.glb"), description("twice.glb"));
    const Json json = Json::parse(run_kokage({"describe", "once.glb", "--json"}, folder.path()).output);
    EXPECT_EQ(json["shaded"], true);
}

TEST(Shade, MistakesAreFoundBeforeTheWork) {
    TemporaryFolder folder;
    std::ofstream(folder / "sky.exr") << "no image";
    std::ofstream(folder / "t.glb") << "no tree";
    const std::vector<std::pair<Words, std::string>> wrongs = {
        {{"--method", "radiosity"}, "path-traced"},
        {{"--method", "paper", "--error", "0.1"}, "--error"},
        {{"--error", "0"}, "--error"},
        {{"--error", "0.05", "--effort", "8"}, "--effort"},
        {{"--bands", "0"}, "--bands"},
        {{"--bands", "41"}, "--bands"},
        {{"--maps", "-1"}, "--maps"},
        {{"--method", "light-maps", "--gather", "sine"}, "rule or cosine"},
        {{"--gather", "rule"}, "--gather"},
        {{"--method", "paper", "--gather", "cosine"}, "--gather"},
        {{"--method", "paper", "--effort", "9"}, "--effort"},
        {{"--method", "path-traced", "--maps", "9"}, "--maps"},
        {{"--method", "path-traced", "--bands", "9"}, "--bands"},
        {{"--maps", "9", "--image", "x.png"}, "-o OUT.glb"},
        {{"--seed", "-1"}, "--seed"},
        {{"--seed", "1.5"}, "--seed"},
        {{"--seed", "18446744073709551616"}, "--seed"},
        {{"--sun", "1,2,3"}, "--sun"},
        {{"--sun", "0,91"}, "--sun"},
        {{"--environment", "constant", "--sun", "0,45"}, "--sun"},
        {{"--environment", "constant:-1"}, "constant"},
        {{"--environment", "gradient:1,2"}, "gradient"},
        {{"--environment", "missing.hdr"}, "missing.hdr"},
        {{"--environment", "."}, "folder"},
        {{"--environment", "sky.exr"}, "sky.exr"},
        {{"--light", "candle:1"}, "candle"},
        {{"--ground", "--no-ground"}, "ground"},
        {{"--no-ground", "--ground-albedo", "0.2"}, "--ground-albedo"},
        {{"--ground-albedo", "1.5"}, "--ground-albedo"},
        {{"--leaf-reflectance", "0.7", "--leaf-transmittance", "0.4"}, "more than 1"},
        {{"--leaf-reflectance", "green"}, "green"},
        {{"--image-size", "big"}, "big"},
        {{"--samples", "0"}, "--samples"},
        {{"--exposure", "nan"}, "--exposure"},
        {{"-o", "tree.obj"}, ".glb"},
        {{"--image", "tree.jpg"}, ".png"},
        {{"--report", "tree.txt"}, ".json"},
        {{"-o", "nowhere/tree.glb"}, "nowhere"},
        {{"--image", "x.png", "--split-sides"}, "--split-sides"},
        {{"--environment", "sky.exr", "--image", "sky.exr"}, "sky.exr"},
        {{"--data", "nowhere"}, "nowhere"},
    };
    for (const auto& [words, hint] : wrongs) {
        // A million leaves take half a gigabyte and more: the mistake has to be found before them. (An image that can't
        // be read is found after growing.)
        Words all = {"shade", "oak", "--leaves", words == Words({"--environment", "sky.exr"}) ? "100" : "1000000"};
        all.insert(all.end(), words.begin(), words.end());
        const ProgramRun run = run_kokage(all, folder.path());
        EXPECT_EQ(run.status, 2) << hint << ": " << run.errors;
        EXPECT_TRUE(is_one_complaint(run.errors)) << hint;
        EXPECT_NE(run.errors.find(hint), std::string::npos) << run.errors;
        EXPECT_LT(run.peak_megabytes, 300) << hint;
    }
    const ProgramRun overwriting = run_kokage({"shade", "t.glb", "-o", "t.glb"}, folder.path());
    EXPECT_EQ(overwriting.status, 2);
    EXPECT_NE(overwriting.errors.find("overwritten"), std::string::npos) << overwriting.errors;
    EXPECT_EQ(folder.files(), Words({"sky.exr", "t.glb"}));
    EXPECT_EQ(read_text(folder / "sky.exr") + read_text(folder / "t.glb"), "no imageno tree");
}

TEST(Shade, StopsOnCtrlCAndLeavesNothingHalfWritten) {
    TemporaryFolder folder;
    std::ofstream(folder / "oak.glb") << "an older oak";
    const ProgramRun run =
        run_kokage({"shade", "oak", "--leaves", "20000", "--method", "path-traced", "--effort", "100000"},
                   folder.path(), {.interrupt_after_seconds = 1.5});
    EXPECT_EQ(run.status, 130);
    EXPECT_TRUE(is_one_complaint(run.errors));
    EXPECT_EQ(folder.files(), Words({"oak.glb"}));
    EXPECT_EQ(read_text(folder / "oak.glb"), "an older oak");
}

TEST(Shade, DataFolderIsSearchedForNamesThatAreNotHere) {
    TemporaryFolder folder;
    std::filesystem::create_directory(folder / "data");
    ASSERT_EQ(run_kokage({"grow", "--leaves", "50", "-o", "data/tiny.glb", "--quiet"}, folder.path()).status, 0);
    const ProgramRun run = run_kokage({"shade", "tiny.glb", "--data", "data", "--report", "r.json"}, folder.path());
    EXPECT_EQ(run.status, 0) << run.errors;
}

TEST(Shade, NoFoliageIsAWarningAndNoSuccess) {
    TemporaryFolder folder;
    std::ofstream(folder / "post.obj") << "v 0 0 0\nv 0.1 0 0\nv 0 0 0.1\nv 0 2 0\nusemtl paint\n"
                                       << "f 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n";
    const ProgramRun run = run_kokage({"shade", "post.obj", "--effort", "16", "--report", "r.json"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_NE(run.errors.find("no foliage was found"), std::string::npos) << run.errors;
    EXPECT_NE(run.errors.find("--foliage NAME"), std::string::npos) << run.errors;
    EXPECT_NE(run.errors.find("'paint'"), std::string::npos) << run.errors;
    EXPECT_EQ(run.output.find("estimated error"), std::string::npos) << run.output;
    const Json report = Json::parse(read_text(folder / "r.json"));
    EXPECT_TRUE(report["estimated_error"].is_null());
    EXPECT_NE(report["warnings"].dump().find("--foliage NAME"), std::string::npos);
    // A tree grown bare is meant to be bare.
    const ProgramRun bare = run_kokage(
        {"shade", "oak", "--leaves", "100", "--set", "season=winter", "--effort", "16", "--report", "w.json"},
        folder.path());
    ASSERT_EQ(bare.status, 0) << bare.errors;
    EXPECT_EQ(bare.errors.find("foliage"), std::string::npos) << bare.errors;
    EXPECT_TRUE(Json::parse(read_text(folder / "w.json"))["estimated_error"].is_null());
}

TEST(Compare, DifferentTreesAndUnshadedTreesAreRefused) {
    TemporaryFolder folder;
    ASSERT_EQ(run_kokage(small_shade({"-o", "a.glb", "--quiet"}), folder.path()).status, 0);
    ASSERT_EQ(run_kokage(small_shade({"-o", "b.glb", "--quiet", "--set", "seed=2"}), folder.path()).status, 0);
    ASSERT_EQ(run_kokage({"grow", "--leaves", "200", "-o", "bare.glb", "--quiet"}, folder.path()).status, 0);
    save_image(folder / "p.png", Image(4, 4, 3));
    for (const Words& words : {Words{"compare", "a.glb", "b.glb"}, Words{"compare", "a.glb", "bare.glb"},
                               Words{"compare", "a.glb", "p.png"}}) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2) << words.back();
        EXPECT_TRUE(is_one_complaint(run.errors));
    }
    const ProgramRun self = run_kokage({"compare", "a.glb", "a.glb", "-o", "map.png"}, folder.path());
    EXPECT_EQ(self.status, 0) << self.errors;
    EXPECT_NE(self.output.find("mean relative error   0 %"), std::string::npos) << self.output;
    EXPECT_FALSE(load_image(folder / "map.png").empty());
}

} // namespace
} // namespace kokage

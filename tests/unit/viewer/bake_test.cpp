// `kokage bake` as a user runs it: the maps that it writes.
#include "common/scene/image_file.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/harmonics_file.h"
#include "reflection/maps/map_file.h"
#include "tests/unit/viewer/bake_runs.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>

namespace kokage {
namespace {

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

} // namespace
} // namespace kokage

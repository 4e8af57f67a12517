// The memory of `kokage bake`: planned, refused where it is not to be had, and not exceeded.
#include "common/scene/image_file.h"
#include "reflection/maps/baked_map.h"
#include "tests/unit/viewer/bake_runs.h"

#include <fstream>

namespace kokage {
namespace {

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

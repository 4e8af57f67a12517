// `kokage bake` on videos.
#include "common/scene/image_file.h"
#include "tests/unit/viewer/bake_runs.h"

#include <fstream>

namespace kokage {
namespace {

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

} // namespace
} // namespace kokage

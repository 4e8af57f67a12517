// The program at its limits: every run ends, with a result or with one line that says why not.
#include "common/scene/image_file.h"
#include "tests/support/program_run.h"

#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::json;
using Words = std::vector<std::string>;

Json shaded(const TemporaryFolder& folder, const Words& more) {
    Words words = {"shade", "--report", "r.json"};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = run_kokage(words, folder.path());
    EXPECT_EQ(run.status, 0) << run.errors;
    return run.status == 0 ? Json::parse(read_text(folder / "r.json")) : Json();
}

/// The report writes null for what is not finite.
bool all_finite(const Json& numbers) {
    return std::all_of(numbers.begin(), numbers.end(), [](const Json& value) { return value.is_number(); });
}

TEST(ProgramStress, OneLeaf) {
    TemporaryFolder folder;
    for (const char* method : {"paper", "light-maps", "bundles", "path-traced"}) {
        const Json r = shaded(
            folder, {"--leaves", "1", "--method", method, "-o", "t.glb", "--image", "t.png", "--image-size", "16x16"});
        EXPECT_EQ(r["counts"]["leaves"], 1) << method;
        EXPECT_TRUE(all_finite(r["residuals"])) << method;
    }
}

TEST(ProgramStress, DarknessAndExtremeLights) {
    TemporaryFolder folder;
    const Words small = {"oak", "--leaves", "100", "--image", "t.png", "--image-size", "16x16", "-o", "t.glb"};
    for (const Words& light :
         {Words{"--environment", "constant:0"}, Words{"--environment", "constant:1e30"},
          Words{"--environment", "constant:1e-30"}, Words{"--environment", "constant:0", "--light", "point:0,1,0,1e30"},
          Words{"--sun", "0,-90"}, Words{"--sun", "720,90"}}) {
        Words words = small;
        words.insert(words.end(), light.begin(), light.end());
        const Json r = shaded(folder, words);
        EXPECT_TRUE(all_finite(r["residuals"])) << light.back();
        for (float value : load_image(folder / "t.png").pixels)
            ASSERT_TRUE(value >= 0 && value <= 1);
    }
}

TEST(ProgramStress, LeavesThatAbsorbNothingAndLeavesThatAbsorbAll) {
    TemporaryFolder folder;
    Json r = shaded(folder, {"--leaves", "200", "--leaf-reflectance", "0.5", "--leaf-transmittance", "0.5",
                             "--bark-albedo", "1", "--environment", "constant"});
    EXPECT_TRUE(all_finite(r["residuals"]));
    r = shaded(folder,
               {"--leaves", "200", "--leaf-reflectance", "0", "--leaf-transmittance", "0", "--bark-albedo", "0"});
    EXPECT_TRUE(all_finite(r["residuals"]));
}

TEST(ProgramStress, FilesOfEveryBrokenKind) {
    TemporaryFolder folder;
    ASSERT_EQ(run_kokage({"grow", "--leaves", "20", "-o", "good.glb", "--quiet"}, folder.path()).status, 0);
    const std::string good = read_text(folder / "good.glb");
    const Words cut_off = {"", "glTF", good.substr(0, 12), good.substr(0, good.size() / 2),
                           good.substr(0, good.size() - 1)};
    Words flipped;
    for (std::size_t place : {4u, 8u, 12u, 16u, 20u, 200u, 1000u}) {
        flipped.push_back(good);
        flipped.back()[place] = char(~flipped.back()[place]);
    }
    const auto describe = [&](const std::string& bytes) {
        std::ofstream(folder / "broken.glb", std::ios::binary) << bytes;
        return run_kokage({"describe", "broken.glb"}, folder.path());
    };
    for (const std::string& bytes : cut_off) {
        const ProgramRun run = describe(bytes);
        EXPECT_EQ(run.status, 2) << bytes.size();
        EXPECT_TRUE(is_one_complaint(run.errors)) << bytes.size();
    }
    for (const std::string& bytes : flipped) {
        const ProgramRun run = describe(bytes);
        EXPECT_TRUE(run.status == 2 ? is_one_complaint(run.errors) : testing::AssertionResult(run.status == 0))
            << run.errors;
    }
}

TEST(ProgramStress, StoppedWhileGrowing) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage({"grow", "--leaves", "2000000"}, folder.path(), {.interrupt_after_seconds = 0.7});
    EXPECT_EQ(run.status, 130) << run.errors;
    EXPECT_EQ(folder.files(), Words());
}

TEST(ProgramStress, FullDiskIsSaid) {
    TemporaryFolder folder; // /dev/full takes nothing; a link to it is followed
    std::filesystem::create_symlink("/dev/full", folder / "full.glb");
    const ProgramRun run = run_kokage({"grow", "--leaves", "20", "-o", "full.glb"}, folder.path());
    EXPECT_EQ(run.status, 2) << run.errors;
    EXPECT_TRUE(is_one_complaint(run.errors));
    EXPECT_EQ(folder.files(), Words({"full.glb"}));
}

TEST(ProgramStress, NamesOfAllKinds) {
    TemporaryFolder folder;
    for (const char* name : {"with space.glb", "quote's.glb", "ümläut 木陰.glb", "-leading.glb", "a=b,c;d.glb"}) {
        const std::string place = (folder / name).string();
        ASSERT_EQ(run_kokage({"grow", "--leaves", "10", "-o", place, "--quiet"}, folder.path()).status, 0) << name;
        const ProgramRun run = run_kokage({"describe", place}, folder.path());
        EXPECT_EQ(run.status, 0) << name << run.errors;
    }
    const ProgramRun run = run_kokage({"grow", "--leaves", "10", "-o", std::string(300, 'x') + ".glb"}, folder.path());
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(is_one_complaint(run.errors));
}

} // namespace
} // namespace kokage

// `kokage grow --seeds`: many trees, a manifest, and going on after a stop.
#include "common/services/error.h"
#include "tests/support/program_run.h"
#include "viewer/grow_variants.h"

#include <nlohmann/json.hpp>

namespace kokage {
namespace {
using Json = nlohmann::json;
using Words = std::vector<std::string>;

ProgramRun grow_seeds(const TemporaryFolder& folder, const std::string& seeds, const Words& more = {}) {
    Words words = {"grow", "birch", "--leaves", "60", "--seeds", seeds, "-o", "trees"};
    words.insert(words.end(), more.begin(), more.end());
    return run_kokage(words, folder.path());
}

Json manifest(const TemporaryFolder& folder) {
    return Json::parse(read_text(folder / "trees/manifest.json"));
}

TEST(GrowVariants, WritesATreeForEverySeedAndListsThem) {
    const TemporaryFolder folder;
    const ProgramRun run = grow_seeds(folder, "3..5");
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.output.rfind("trees: 3 trees grown in ", 0), 0u) << run.output;
    const Json listed = manifest(folder);
    EXPECT_EQ(listed["species"], "birch");
    EXPECT_EQ(listed["parameters"]["leaves"], 60);
    ASSERT_EQ(listed["trees"].size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) {
        const Json& tree = listed["trees"][i];
        EXPECT_EQ(tree["seed"], 3 + i);
        EXPECT_EQ(tree["leaves"], 60);
        EXPECT_GT(tree["height_m"], 0.3);
        EXPECT_EQ(std::filesystem::file_size(folder / ("trees/" + std::string(tree["file"]))), tree["bytes"]);
    }
    ASSERT_EQ(run_kokage({"grow", "birch", "--leaves", "60", "--seed", "4", "-o", "alone.glb"}, folder.path()).status,
              0);
    EXPECT_EQ(read_text(folder / "alone.glb"), read_text(folder / "trees/birch-4.glb"));
    EXPECT_NE(read_text(folder / "trees/birch-3.glb"), read_text(folder / "trees/birch-4.glb"));
}

TEST(GrowVariants, GoesOnWhereItWasAndMendsWhatIsMissing) {
    const TemporaryFolder folder;
    ASSERT_EQ(grow_seeds(folder, "1..2").status, 0);
    const std::string first = read_text(folder / "trees/birch-1.glb"), second = read_text(folder / "trees/birch-2.glb");
    std::ofstream(folder / "trees/birch-1.glb") << "cut off";
    std::filesystem::remove(folder / "trees/birch-2.glb");
    ASSERT_EQ(grow_seeds(folder, "2..3").status, 0);
    EXPECT_EQ(read_text(folder / "trees/birch-2.glb"), second);
    EXPECT_EQ(manifest(folder)["trees"].size(), 3u) << "other seeds stay listed";
    const ProgramRun again = grow_seeds(folder, "1..3");
    EXPECT_NE(again.output.find("1 tree grown in "), std::string::npos) << again.output;
    EXPECT_NE(again.output.find("2 kept from before"), std::string::npos) << again.output;
    EXPECT_EQ(read_text(folder / "trees/birch-1.glb"), first);
}

TEST(GrowVariants, StoppedItKeepsWhatWasGrown) {
    const TemporaryFolder folder;
    const ProgramRun run = run_kokage({"grow", "birch", "--leaves", "1000", "--seeds", "1..100000", "-o", "trees"},
                                      folder.path(), {.interrupt_after_seconds = 4});
    EXPECT_EQ(run.status, 130);
    const Json listed = manifest(folder);
    ASSERT_GE(listed["trees"].size(), 1u);
    const std::size_t there = listed["trees"].size();
    EXPECT_EQ(run.errors, "kokage: stopped; " + std::to_string(there) + " of 100,000 trees " +
                              (there == 1 ? "is" : "are") + " in 'trees'; the same command goes on\n");
    std::size_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "trees"))
        files += entry.path().extension() == ".glb";
    EXPECT_GE(listed["trees"].size() + 1, files) << "at most one more than is listed, and no temporary file";
    for (const Json& tree : listed["trees"])
        EXPECT_EQ(std::filesystem::file_size(folder / ("trees/" + std::string(tree["file"]))), tree["bytes"]);
}

TEST(GrowVariants, RefusesAFolderOfOtherTrees) {
    const TemporaryFolder folder;
    ASSERT_EQ(grow_seeds(folder, "1..1").status, 0);
    const ProgramRun other = grow_seeds(folder, "2..2", {"--set", "crown_base=0.3"});
    EXPECT_EQ(other.status, 2);
    EXPECT_NE(other.errors.find("holds other trees: their crown_base is 0."), std::string::npos) << other.errors;
    EXPECT_EQ(manifest(folder)["trees"].size(), 1u);
    std::ofstream(folder / "trees/manifest.json") << R"({"trees": [{"seed": 1, "file": "../../x.glb", "bytes": 3}]})";
    const ProgramRun odd = grow_seeds(folder, "1..1");
    EXPECT_EQ(odd.status, 2);
    EXPECT_NE(odd.errors.find("can't be read as a manifest"), std::string::npos) << odd.errors;
}

TEST(GrowVariants, SeedsAreTwoWholeNumbers) {
    EXPECT_EQ(seeds_from("7..9").first, 7u);
    EXPECT_EQ(seeds_from("7..9").last, 9u);
    for (const char* text :
         {"", "5", "5..", "..5", "5...6", "9..7", "-1..3", "1..2000000", "1,5", "1..99999999999999999999"})
        EXPECT_THROW(seeds_from(text), InputError) << text;
    const TemporaryFolder folder;
    EXPECT_EQ(run_kokage({"grow", "--seeds", "1..2", "--seed", "3"}, folder.path()).status, 2);
    EXPECT_EQ(run_kokage({"grow", "--seeds", "1..2", "-o", "t.glb"}, folder.path()).status, 2);
    const ProgramRun turned = run_kokage({"grow", "--seeds", "5..2", "-o", "t.glb"}, folder.path());
    EXPECT_NE(turned.errors.find("is the wrong way round"), std::string::npos) << turned.errors;
    EXPECT_TRUE(folder.files().empty());
}

} // namespace
} // namespace kokage

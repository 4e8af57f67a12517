// `kokage grow`, and that what it writes is read again.
#include "tests/support/program_run.h"

namespace kokage {
namespace {

TEST(Grow, WritesATreeThatReadsAsTheSameTree) {
    TemporaryFolder folder;
    const ProgramRun grown = run_kokage({"grow", "--leaves", "400", "--seed", "5", "-o", "my oak.glb"}, folder.path());
    ASSERT_EQ(grown.status, 0) << grown.errors;
    EXPECT_EQ(grown.output.rfind("my oak.glb: 400 leaves, ", 0), 0u) << grown.output;
    EXPECT_EQ(folder.files(), std::vector<std::string>({"my oak.glb"}));

    const ProgramRun from_file = run_kokage({"describe", "my oak.glb"}, folder.path());
    const ProgramRun from_species =
        run_kokage({"describe", "oak", "--leaves", "400", "--set", "seed=5"}, folder.path());
    ASSERT_EQ(from_file.status, 0) << from_file.errors;
    const auto body = [](const std::string& text) {
        return text.substr(text.find('\n'));
    }; // the first line names the source
    EXPECT_EQ(body(from_file.output), body(from_species.output));
}

TEST(Grow, SeedDecidesTheFileAndThreadsDoNot) {
    TemporaryFolder folder;
    const auto grown = [&](const std::string& seed, const std::string& threads) {
        run_kokage({"grow", "--leaves", "3000", "--seed", seed, "--threads", threads, "-o", "t.glb", "--quiet"},
                   folder.path());
        return read_text(folder / "t.glb");
    };
    const std::string one = grown("1", "1");
    ASSERT_FALSE(one.empty());
    EXPECT_EQ(one, grown("1", "4"));
    EXPECT_NE(one, grown("2", "1"));
}

TEST(Grow, DefaultNameIsTheSpeciesAndQuietSaysNothing) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage({"grow", "OAK", "--leaves", "50", "--quiet"}, folder.path());
    ASSERT_EQ(run.status, 0) << run.errors;
    EXPECT_EQ(run.output + run.errors, "");
    EXPECT_EQ(folder.files(), std::vector<std::string>({"oak.glb"}));
}

TEST(Grow, ListsSpeciesAndParameters) {
    TemporaryFolder folder;
    EXPECT_NE(run_kokage({"grow", "--list"}, folder.path()).output.find("Quercus robur"), std::string::npos);
    const std::string parameters = run_kokage({"grow", "--describe", "oak"}, folder.path()).output;
    for (const char* name : {"\n  seed ", "\n  leaves ", "\n  leaf_form ", "\n  height_to_width "})
        EXPECT_NE(parameters.find(name), std::string::npos) << name;
    EXPECT_TRUE(folder.files().empty());
}

TEST(Grow, ASpeciesFileOfOnesOwnIsWrittenChangedAndGrown) {
    TemporaryFolder folder;
    const ProgramRun described = run_kokage(
        {"grow", "--describe", "beech", "--set", "leaf_length=0.09", "--seed", "3", "-o", "mine.json"}, folder.path());
    ASSERT_EQ(described.status, 0) << described.errors;
    EXPECT_NE(read_text(folder / "mine.json").find("\"leaf_length\": 0.09"), std::string::npos);
    EXPECT_NE(run_kokage({"grow", "--describe", "mine.json"}, folder.path()).output.find("leaf_length            0.09"),
              std::string::npos);
    const auto body = [&](const std::vector<std::string>& words) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 0) << run.errors;
        return run.output.substr(run.output.find('\n'));
    };
    EXPECT_EQ(body({"describe", "mine.json", "--leaves", "300"}),
              body({"describe", "beech", "--leaves", "300", "--set", "seed=3", "--set", "leaf_length=0.09"}));
    const ProgramRun grown = run_kokage({"grow", "mine.json", "--leaves", "100"}, folder.path());
    EXPECT_EQ(grown.status, 0) << grown.errors;
    EXPECT_EQ(folder.files(), std::vector<std::string>({"mine.glb", "mine.json"}));
}

TEST(Grow, ASpeciesFileIsNeverOverwrittenByWhatItGivesAndSaysWhatIsWrongInIt) {
    TemporaryFolder folder;
    const std::string wrong = R"({"name": "mine", "parameters": {"limb": 3}})";
    std::ofstream(folder / "wrong.json") << wrong;
    std::ofstream(folder / "good.json") << R"({"name": "mine"})";
    for (const auto& words :
         std::vector<std::vector<std::string>>{{"grow", "wrong.json"},
                                               {"shade", "wrong.json"},
                                               {"describe", "wrong.json"},
                                               {"grow", "none.json"},
                                               {"grow", "--describe", "none.json"},
                                               {"grow", "--describe", "good.json", "-o", "good.json"},
                                               {"grow", "--describe", "good.json", "-o", "good.txt"},
                                               {"shade", "good.json", "--leaves", "20", "--report", "good.json"}}) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2) << words.back() << run.errors;
        EXPECT_TRUE(is_one_complaint(run.errors)) << words.back();
    }
    EXPECT_EQ(folder.files(), std::vector<std::string>({"good.json", "wrong.json"}));
    EXPECT_EQ(read_text(folder / "wrong.json"), wrong);
}

TEST(Grow, WrongWordsAreRefusedAndNothingIsWritten) {
    TemporaryFolder folder;
    const std::vector<std::vector<std::string>> wrongs = {{"grow", "baobab"},
                                                          {"grow", "--describe", "baobab"},
                                                          {"grow", "oak", "-o", "tree"},
                                                          {"grow", "oak", "-o", "tree.obj"},
                                                          {"grow", "oak", "-o", "nowhere/tree.glb"},
                                                          {"grow", "oak", "-o", "."},
                                                          {"grow", "oak", "--leaves", "-5"},
                                                          {"grow", "oak", "--seed", "many"},
                                                          {"grow", "oak", "--set", "leaf_length=nan"},
                                                          {"grow", "oak", "elm"}};
    for (const auto& words : wrongs) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2) << words.back() << run.errors;
        EXPECT_TRUE(is_one_complaint(run.errors)) << words.back();
    }
    EXPECT_TRUE(folder.files().empty());
}

} // namespace
} // namespace kokage

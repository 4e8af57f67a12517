// The program's first contact: help, version, mistakes on the command line.
#include "tests/support/program_run.h"

namespace kokage {
namespace {

TEST(CommandLine, BareProgramShowsHelp) {
    TemporaryFolder folder;
    const ProgramRun bare = run_kokage({}, folder.path());
    const ProgramRun help = run_kokage({"--help"}, folder.path());
    EXPECT_EQ(bare.status, 0);
    EXPECT_EQ(help.status, 0);
    EXPECT_EQ(bare.output, help.output);
    EXPECT_NE(help.output.find("kokage COMMAND --help"), std::string::npos);
    EXPECT_TRUE(help.errors.empty());
}

TEST(CommandLine, VersionIsOneLine) {
    TemporaryFolder folder;
    const ProgramRun run = run_kokage({"--version"}, folder.path());
    EXPECT_EQ(run.status, 0);
    EXPECT_EQ(run.output.rfind("kokage ", 0), 0u);
}

TEST(CommandLine, UnknownCommandIsNamed) {
    TemporaryFolder folder;
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"prune"}, {"prune", "--help"}, {"prune", "oak.glb", "--threads", "2"}}) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2);
        EXPECT_TRUE(is_one_complaint(run.errors));
        EXPECT_NE(run.errors.find("no command 'prune'; commands: grow, describe,"), std::string::npos) << run.errors;
        EXPECT_EQ(run.output, "");
    }
}

TEST(CommandLine, EveryCommandHasHelpWithAnExample) {
    TemporaryFolder folder;
    const std::string help = run_kokage({"--help"}, folder.path()).output;
    for (const std::string command : {"grow", "describe", "shade", "render", "bake", "compare", "bench"}) {
        EXPECT_NE(help.find("\n  " + command + " "), std::string::npos) << command;
        const ProgramRun run = run_kokage({command, "--help"}, folder.path());
        EXPECT_EQ(run.status, 0);
        EXPECT_NE(run.output.find(": kokage " + command + " ", run.output.find("\nExample")), std::string::npos)
            << run.output;
        EXPECT_NE(run.output.find("--quiet"), std::string::npos);
        EXPECT_NE(run.output.find("--threads"), std::string::npos);
    }
}

TEST(CommandLine, GeneralOptionsStandBeforeOrAfterEveryCommand) {
    TemporaryFolder folder;
    const std::vector<std::vector<std::string>> commands = {
        {"grow", "--help"},  {"describe", "--help"}, {"shade", "--help"},         {"render", "--help"},
        {"bake", "--help"},  {"compare", "--help"},  {"render", "--example"},     {"bench", "--help"},
        {"bench", "roots"},  {"compare", "a", "b"},  {"render", "no-such.scene"}, {"shade", "no-such.glb"},
        {"bake", "no-such"}, {"grow", "no-such"}};
    for (const std::vector<std::string>& command : commands) {
        std::vector<std::string> before = {"--quiet", "--threads", "2"}, after = command;
        before.insert(before.end(), command.begin(), command.end());
        after.insert(after.end(), {"--quiet", "--threads", "2"});
        const ProgramRun one = run_kokage(before, folder.path()), other = run_kokage(after, folder.path());
        EXPECT_EQ(one.status, other.status) << command.front() << ": " << one.errors;
        EXPECT_EQ(one.output, other.output) << command.front();
        EXPECT_EQ(one.errors, other.errors) << command.front();
        EXPECT_EQ(one.errors.find("expected"), std::string::npos) << one.errors;
    }
    const ProgramRun quiet = run_kokage({"--quiet", "grow", "birch", "--leaves", "20"}, folder.path());
    EXPECT_EQ(quiet.status, 0) << quiet.errors;
    EXPECT_EQ(quiet.output, "");
    const ProgramRun twice = run_kokage({"--threads", "2", "describe", "birch", "--threads", "3"}, folder.path());
    EXPECT_EQ(twice.status, 2);
    EXPECT_TRUE(is_one_complaint(twice.errors));
    EXPECT_NE(twice.errors.find("--threads"), std::string::npos);
}

TEST(CommandLine, UnknownBenchmarksAreRefused) {
    TemporaryFolder folder;
    for (const std::vector<std::string>& words :
         {std::vector<std::string>{"bench"}, {"bench", "foliage"}, {"bench", "roots", "-o", "r"}}) {
        const ProgramRun run = run_kokage(words, folder.path());
        EXPECT_EQ(run.status, 2);
        EXPECT_TRUE(is_one_complaint(run.errors));
    }
    EXPECT_TRUE(folder.files().empty());
}

} // namespace
} // namespace kokage

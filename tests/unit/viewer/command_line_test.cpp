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
    for (const std::string command : {"grow", "describe", "shade", "compare", "bench"}) {
        EXPECT_NE(help.find("\n  " + command + " "), std::string::npos) << command;
        const ProgramRun run = run_kokage({command, "--help"}, folder.path());
        EXPECT_EQ(run.status, 0);
        EXPECT_NE(run.output.find("Example: kokage " + command + " "), std::string::npos) << run.output;
        EXPECT_NE(run.output.find("--quiet"), std::string::npos);
        EXPECT_NE(run.output.find("--threads"), std::string::npos);
    }
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

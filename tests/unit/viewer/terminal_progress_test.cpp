// What the progress line says, and that it is drawn on terminals alone.
#include "viewer/terminal_progress.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace kokage {
namespace {

TEST(ProgressLine, SaysStageShareAndTimeLeft) {
    EXPECT_EQ(progress_line("tracing paths", 45, 100, 9), "tracing paths   45 %  11 s left");
    EXPECT_EQ(progress_line("tracing paths", 10, 100, 100), "tracing paths   10 %  15 min 00 s left");
    EXPECT_EQ(progress_line("tracing paths", 0, 100, 9), "tracing paths    0 %");
    EXPECT_EQ(progress_line("tracing paths", 100, 100, 9), "tracing paths  100 %");
}

TEST(ProgressLine, MoreStepsThanAnnouncedStayAtTheEnd) {
    EXPECT_EQ(progress_line("growing", 300, 100, 9), "growing  100 %");
}

TEST(ProgressLine, UnknownTotalShowsElapsedTime) {
    EXPECT_EQ(progress_line("loading", 0, 0, 2.2), "loading  3 s");
}

// False in a bare chroot, where /dev/pts is not mounted.
bool terminals_can_be_had() {
    int master = -1, slave = -1;
    if (openpty(&master, &slave, nullptr, nullptr, nullptr) != 0)
        return false;
    close(master);
    close(slave);
    return true;
}

// What a child process with a terminal as its stderr wrote there.
std::string drawn_on_a_terminal(void (*work)()) {
    int terminal = -1;
    const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
    if (child == 0) {
        setenv("TERM", "xterm", 1);
        work();
        _exit(0);
    }
    std::string text;
    char bytes[256];
    for (ssize_t count; (count = read(terminal, bytes, sizeof bytes)) > 0;)
        text.append(bytes, std::size_t(count));
    int state = 0;
    waitpid(child, &state, 0);
    close(terminal);
    return text;
}

TEST(TerminalProgress, DrawsLongStagesAndClearsTheLine) {
    if (!terminals_can_be_had())
        GTEST_SKIP() << "skipped: this system hands out no terminals (/dev/pts is not mounted)";
    const std::string text = drawn_on_a_terminal([] {
        TerminalProgress progress(stderr_is_terminal());
        progress.begin("short work", 10);
        progress.advance(5);
        usleep(150'000);
        progress.begin("long work", 10);
        progress.advance(5);
        usleep(900'000);
    });
    EXPECT_EQ(text.find("short work"), std::string::npos) << text;
    EXPECT_NE(text.find("long work   50 %"), std::string::npos) << text;
    ASSERT_GE(text.size(), 4u);
    EXPECT_EQ(text.substr(text.size() - 4), "\r\033[K");
    EXPECT_EQ(text.find('\n'), std::string::npos);
}

TEST(TerminalProgress, IsSilentWhenAskedTo) {
    if (!terminals_can_be_had())
        GTEST_SKIP() << "skipped: this system hands out no terminals (/dev/pts is not mounted)";
    const std::string text = drawn_on_a_terminal([] {
        TerminalProgress progress(false);
        progress.begin("long work", 10);
        usleep(800'000);
    });
    EXPECT_EQ(text, "");
}

} // namespace
} // namespace kokage

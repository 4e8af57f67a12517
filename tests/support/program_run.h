#pragma once
// Runs the program `kokage` as a user would.
#include "tests/support/temporary_folder.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <gtest/gtest.h>
#include <string>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace kokage {

struct ProgramRun {
    int status = -1; ///< exit status; 128 + signal if a signal ended it
    std::string output, errors;
    double peak_megabytes = 0; ///< of memory
};

struct ProgramRunOptions {
    /// > 0: SIGINT is sent so long after the program has begun to listen to it (which takes a busy machine a while).
    double interrupt_after_seconds = 0;
    std::uint64_t address_space = 0; ///< > 0: bytes that it may take (ulimit -v)
    std::uint64_t file_size = 0;     ///< > 0: bytes that each of its files may have (ulimit -f)
};

/// Waits until a process catches SIGINT, has ended, or nothing can be known of it.
inline void wait_until_it_listens(pid_t process) {
    const std::string status = "/proc/" + std::to_string(process) + "/status";
    for (;;) {
        const std::string text = read_text(status);
        const std::size_t caught = text.find("SigCgt:");
        if (caught == std::string::npos || text.find("State:\tZ") != std::string::npos ||
            (std::stoull(text.substr(caught + 7), nullptr, 16) >> (SIGINT - 1) & 1))
            return;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
}

/// Runs `kokage` with arguments in a folder and waits for it.
inline ProgramRun run_kokage(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                             const ProgramRunOptions& options = {}) {
    TemporaryFolder streams;
    const std::string output = (streams / "output").string(), errors = (streams / "errors").string();
    std::vector<std::string> words{KOKAGE_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);
    const pid_t child = fork();
    if (child == 0) {
        const rlimit limit{options.address_space, options.address_space},
            of_files{options.file_size, options.file_size};
        if ((options.address_space > 0 && setrlimit(RLIMIT_AS, &limit) != 0) ||
            (options.file_size > 0 && setrlimit(RLIMIT_FSIZE, &of_files) != 0))
            _exit(125);
        if (chdir(folder.c_str()) != 0 || !freopen(output.c_str(), "w", stdout) ||
            !freopen(errors.c_str(), "w", stderr) || !freopen("/dev/null", "r", stdin))
            _exit(126);
        execv(argv[0], argv.data());
        _exit(127);
    }
    if (options.interrupt_after_seconds > 0) {
        wait_until_it_listens(child);
        std::this_thread::sleep_for(std::chrono::duration<double>(options.interrupt_after_seconds));
        kill(child, SIGINT);
    }
    int state = 0;
    rusage used{};
    while (wait4(child, &state, 0, &used) < 0 && errno == EINTR) {
    }
    ProgramRun run;
    run.status = WIFEXITED(state) ? WEXITSTATUS(state) : 128 + WTERMSIG(state);
    run.peak_megabytes = double(used.ru_maxrss) / 1024;
    run.output = read_text(output);
    run.errors = read_text(errors);
    return run;
}

/// True for exactly one line that begins as all of the program's complaints do.
inline testing::AssertionResult is_one_complaint(const std::string& errors) {
    if (errors.rfind("kokage: ", 0) == 0 && errors.find('\n') == errors.size() - 1)
        return testing::AssertionSuccess();
    return testing::AssertionFailure() << "not one line that begins with 'kokage: ': " << errors;
}

} // namespace kokage

#include "viewer/stop_signal.h"

#include <atomic>
#include <csignal>
#include <unistd.h>

namespace kokage {
namespace {
std::atomic<bool> stop_flag{false};
std::atomic<int> writers{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free,
              "a signal handler may only touch lock-free variables");

void on_stop_signal(int) {
    if (stop_flag.exchange(true) && writers.load() == 0)
        _exit(130);
}
} // namespace

void watch_stop_signals() {
    struct sigaction action {};
    action.sa_handler = on_stop_signal;
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    std::signal(SIGXFSZ, SIG_IGN);
    for (int signal : {SIGINT, SIGTERM, SIGHUP})
        sigaction(signal, &action, nullptr);
}

bool stop_signal_received() {
    return stop_flag.load(std::memory_order_relaxed);
}

WritingFiles::WritingFiles() {
    ++writers;
}

WritingFiles::~WritingFiles() {
    --writers;
}

} // namespace kokage

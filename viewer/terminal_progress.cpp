#include "viewer/terminal_progress.h"
#include "common/services/stopwatch.h"
#include "viewer/stop_signal.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <sys/ioctl.h>
#include <unistd.h>

namespace kokage {
namespace {
constexpr double kQuietSeconds = 0.5; // shorter stages are not worth a flicker

std::size_t terminal_columns() {
    winsize size{};
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 1)
        return size.ws_col;
    return 80;
}

std::string time_text(double seconds) {
    const auto whole = static_cast<long>(std::ceil(seconds));
    char text[32];
    if (whole < 60)
        std::snprintf(text, sizeof text, "%ld s", whole);
    else
        std::snprintf(text, sizeof text, "%ld min %02ld s", whole / 60, whole % 60);
    return text;
}
} // namespace

bool stderr_is_terminal() {
    const char* terminal = std::getenv("TERM");
    return isatty(STDERR_FILENO) && !(terminal && std::string_view(terminal) == "dumb");
}

std::string progress_line(std::string_view stage, std::size_t done, std::size_t total, double elapsed_seconds) {
    std::string text(stage);
    if (total == 0)
        return text + "  " + time_text(elapsed_seconds);
    const double share = std::min(1.0, double(done) / double(total));
    char percent[16];
    std::snprintf(percent, sizeof percent, "  %3.0f %%", std::floor(100 * share));
    text += percent;
    if (share >= 0.02 && share < 1 && elapsed_seconds > kQuietSeconds)
        text += "  " + time_text(elapsed_seconds * (1 - share) / share) + " left";
    return text;
}

TerminalProgress::TerminalProgress(bool visible) : visible_(visible) {
    if (visible_)
        drawer_ = std::thread([this] { draw_now_and_then(); });
}

TerminalProgress::~TerminalProgress() {
    clear();
    if (!drawer_.joinable())
        return;
    {
        std::lock_guard lock(mutex_);
        ended_ = true;
    }
    wake_.notify_one();
    drawer_.join();
}

void TerminalProgress::begin(std::string_view stage, std::size_t total) {
    std::lock_guard lock(mutex_);
    stage_ = stage;
    total_ = total;
    stage_start_ = wall_seconds();
    done_.store(0, std::memory_order_relaxed);
}

void TerminalProgress::advance(std::size_t steps) {
    done_.fetch_add(steps, std::memory_order_relaxed);
}

bool TerminalProgress::stop_requested() const {
    return stop_signal_received();
}

void TerminalProgress::clear() {
    std::lock_guard lock(mutex_);
    stage_.clear();
    if (drawn_)
        std::fputs("\r\033[K", stderr);
    drawn_ = false;
}

std::string TerminalProgress::line(double now) const {
    std::string text = progress_line(stage_, done_.load(std::memory_order_relaxed), total_, now - stage_start_);
    if (stop_signal_received())
        text = "stopping … (Ctrl-C again ends at once)";
    return text.substr(0, terminal_columns() - 1);
}

void TerminalProgress::draw_now_and_then() {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, std::chrono::milliseconds(100), [this] { return ended_; })) {
        const double now = wall_seconds();
        if (stage_.empty() || (!drawn_ && now - stage_start_ < kQuietSeconds))
            continue;
        std::fprintf(stderr, "\r%s\033[K", line(now).c_str());
        drawn_ = true;
    }
}

} // namespace kokage

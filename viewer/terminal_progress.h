#pragma once
// One line at the foot of the terminal that says what is being done, how far it is and how long it still takes.
#include "common/services/progress.h"

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace kokage {

/// Draws on stderr, at most ten times a second, work that takes longer than half a second. Stops when a stop signal
/// came.
class TerminalProgress : public Progress {
  public:
    /// `visible` false: draws nothing, but still passes stop signals on.
    explicit TerminalProgress(bool visible);
    ~TerminalProgress() override;

    void begin(std::string_view stage, std::size_t total) override;
    void advance(std::size_t steps) override;
    bool stop_requested() const override;
    /// Takes the line away until the next stage begins, so that other text can be printed.
    void clear();

  private:
    void draw_now_and_then();
    std::string line(double now) const;

    bool visible_;
    bool drawn_ = false;
    std::atomic<std::size_t> done_{0};
    mutable std::mutex mutex_; // guards all below, and drawn_
    std::condition_variable wake_;
    std::string stage_;
    std::size_t total_ = 0;
    double stage_start_ = 0;
    bool ended_ = false;
    std::thread drawer_;
};

/// True if progress is worth drawing: stderr is a terminal that can redraw its line.
bool stderr_is_terminal();

/// What the line says: "tracing paths  45 %  12 s left". Time left only once there is something to judge by.
std::string progress_line(std::string_view stage, std::size_t done, std::size_t total, double elapsed_seconds);

} // namespace kokage

#pragma once

namespace kokage {

/// User + system time of the whole process, all threads, in seconds.
double process_cpu_seconds();
/// User + system time of the thread that asks, in seconds.
double thread_cpu_seconds();
/// Monotonic wall-clock time in seconds from an arbitrary start.
double wall_seconds();

/// Measures a piece of work in both clocks.
class Stopwatch {
  public:
    Stopwatch() { restart(); }
    void restart() {
        cpu_start_ = process_cpu_seconds();
        wall_start_ = wall_seconds();
    }
    double cpu() const { return process_cpu_seconds() - cpu_start_; }
    double wall() const { return wall_seconds() - wall_start_; }

  private:
    double cpu_start_ = 0, wall_start_ = 0;
};

} // namespace kokage

#pragma once
// Ctrl-C (SIGINT), SIGTERM and a closed terminal (SIGHUP) ask the work to stop; it stops at its next look at
// stop_requested().
#include "common/services/error.h"

namespace kokage {

/// Stopped after some of many files were written whole; those stay.
struct StoppedBetweenFiles : Stopped {
    /// `what_is_kept`: what the user is told after "stopped; ".
    explicit StoppedBetweenFiles(std::string what_is_kept) : kept(std::move(what_is_kept)) {}
    std::string kept;
};

/// From now on the signals set a flag. A second one ends the program at once, unless files are being written. A file
/// that outgrows its limit (SIGXFSZ) fails as on a full disk, and is taken away, in place of ending the program.
void watch_stop_signals();
/// True once a signal has come.
bool stop_signal_received();

/// While one lives, a second signal doesn't end the program, so that no temporary file is left behind.
class WritingFiles {
  public:
    WritingFiles();
    ~WritingFiles();
    WritingFiles(const WritingFiles&) = delete;
    WritingFiles& operator=(const WritingFiles&) = delete;
};

} // namespace kokage

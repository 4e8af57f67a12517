#pragma once
#include "common/services/progress.h"

namespace kokage {

/// Passes on that the user wants to stop, and keeps the stages of a part of the work to itself.
class OnlyStops : public Progress {
  public:
    explicit OnlyStops(const Progress& progress) : progress_(progress) {}
    bool stop_requested() const override { return progress_.stop_requested(); }

  private:
    const Progress& progress_;
};

} // namespace kokage

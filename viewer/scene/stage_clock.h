#pragma once
#include "common/services/stopwatch.h"
#include "common/services/work_report.h"

#include <string>
#include <utility>

namespace kokage {

/// Times the stages of a command one after the other.
class StageClock {
  public:
    /// Runs `work`, adds its times under `name`, gives back its result. A failed stage adds nothing.
    template <typename Work>
    auto run(const std::string& name, Work&& work) {
        const Stopwatch watch;
        if constexpr (std::is_void_v<decltype(work())>) {
            work();
            stages_.push_back({name, watch.cpu(), watch.wall()});
        } else {
            auto result = work();
            stages_.push_back({name, watch.cpu(), watch.wall()});
            return result;
        }
    }
    const std::vector<WorkReport::Stage>& stages() const { return stages_; }

  private:
    std::vector<WorkReport::Stage> stages_;
};

} // namespace kokage

#include "common/services/parallel.h"

#include <algorithm>
#include <exception>
#include <limits>
#include <memory>
#include <mutex>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

namespace kokage {
namespace {
std::mutex control_mutex;
std::unique_ptr<tbb::global_control> control;

/// The exception of the foremost item that threw. Nothing is thrown through the pipeline itself: that would cut short
/// the parallel work of stages that are to go to their end.
class FirstError {
  public:
    bool is_behind(std::size_t item) const {
        std::lock_guard lock(mutex_);
        return item >= item_;
    }
    void keep(std::size_t item, std::exception_ptr error) {
        std::lock_guard lock(mutex_);
        if (item < item_) {
            item_ = item;
            error_ = std::move(error);
        }
    }
    void rethrow() const {
        if (error_)
            std::rethrow_exception(error_);
    }

  private:
    mutable std::mutex mutex_;
    std::size_t item_ = std::numeric_limits<std::size_t>::max();
    std::exception_ptr error_;
};
} // namespace

void set_thread_count(int threads) {
    std::lock_guard lock(control_mutex);
    control.reset();
    if (threads > 0)
        control = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism, threads);
}

int thread_count() {
    return static_cast<int>(
        std::min<std::size_t>(tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism),
                              tbb::info::default_concurrency()));
}

void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body) {
    if (count == 0)
        return;
    block = std::max<std::size_t>(block, 1);
    const std::size_t blocks = (count + block - 1) / block;
    if (blocks == 1 || thread_count() == 1) {
        for (std::size_t b = 0; b < blocks; ++b)
            body(b * block, std::min(count, (b + 1) * block));
        return;
    }
    tbb::parallel_for(std::size_t(0), blocks,
                      [&](std::size_t b) { body(b * block, std::min(count, (b + 1) * block)); });
}

void parallel_stages(std::size_t places, const std::function<bool(std::size_t)>& first,
                     const std::vector<std::function<void(std::size_t)>>& rest) {
    places = std::max<std::size_t>(places, 1);
    if (places == 1 || thread_count() == 1) {
        while (first(0))
            for (const auto& stage : rest)
                stage(0);
        return;
    }
    FirstError error;
    // Isolated: while a stage waits for its own parallel work, its thread doesn't begin another stage.
    const auto guarded = [&](std::size_t item, const auto& body) {
        if (!error.is_behind(item))
            try {
                tbb::this_task_arena::isolate(body);
            } catch (...) {
                error.keep(item, std::current_exception());
            }
    };
    std::size_t begun = 0;
    tbb::filter<void, std::size_t> all =
        tbb::make_filter<void, std::size_t>(tbb::filter_mode::serial_in_order, [&](tbb::flow_control& control) {
            const std::size_t item = begun++;
            bool is_one = false;
            guarded(item, [&] { is_one = first(item % places); });
            if (!is_one)
                control.stop();
            return item;
        });
    for (const auto& stage : rest)
        all &= tbb::make_filter<std::size_t, std::size_t>(tbb::filter_mode::serial_in_order, [&](std::size_t item) {
            guarded(item, [&] { stage(item % places); });
            return item;
        });
    // In order, the last stage frees an item's place before an item can begin that would take it.
    tbb::parallel_pipeline(
        places, all & tbb::make_filter<std::size_t, void>(tbb::filter_mode::serial_in_order, [](std::size_t) {}));
    error.rethrow();
}

} // namespace kokage

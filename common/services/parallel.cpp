#include "common/services/parallel.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

namespace kokage {
namespace {
std::mutex control_mutex;
std::unique_ptr<tbb::global_control> control;
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

} // namespace kokage

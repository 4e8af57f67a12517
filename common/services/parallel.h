#pragma once
// Threads. Results never depend on how many there are: work is cut into blocks whose borders depend on the input alone,
// each block writes only to its own place, and reductions add the blocks' results in block order.
#include <cstddef>
#include <functional>

namespace kokage {

/// How many threads parallel work may use from now on; 0 = as many as the machine has. Process-wide.
void set_thread_count(int threads);
int thread_count();

/// Calls body(begin, end) for consecutive blocks of at most `block` indices that cover [0, count), in any order, on any
/// thread. An exception of a body is rethrown here once the running blocks have ended.
void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body);

} // namespace kokage

#pragma once
// Threads. Results never depend on how many there are: work is cut into blocks whose borders depend on the input alone,
// each block writes only to its own place, and reductions add the blocks' results in block order.
#include <cstddef>
#include <functional>
#include <vector>

namespace kokage {

/// How many threads parallel work may use from now on; 0 = as many as the machine has. Process-wide.
void set_thread_count(int threads);
int thread_count();

/// Calls body(begin, end) for consecutive blocks of at most `block` indices that cover [0, count), in any order, on any
/// thread. An exception of a body is rethrown here once the running blocks have ended.
void parallel_blocks(std::size_t count, std::size_t block, const std::function<void(std::size_t, std::size_t)>& body);

/// Items pass through stages, in order, while other items are in other stages: a stage works on one item at a time.
/// `first` begins the next item, or returns false when there are no more; `rest` follow in turn. Each is called with
/// the item's place, below `places` (at least 1): whatever belongs to an item lies there, and no more than so many are
/// under way. Stages may use parallel_blocks; with one thread, an item ends before the next one begins. An exception
/// ends the work: items before that one still go to their end, it and those behind it do not, and the exception (of the
/// foremost item, if several throw) is rethrown.
void parallel_stages(std::size_t places, const std::function<bool(std::size_t)>& first,
                     const std::vector<std::function<void(std::size_t)>>& rest);

} // namespace kokage

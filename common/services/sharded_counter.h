#pragma once
// A counter that many threads add to.
#include <array>
#include <atomic>
#include <cstdint>

namespace kokage {

/// Counts without a cache line that all threads fight for.
class ShardedCounter {
  public:
    void add(std::uint64_t amount) {
        static std::atomic<unsigned> threads{0};
        thread_local const unsigned shard = threads++ % kShards;
        shards_[shard].value.fetch_add(amount, std::memory_order_relaxed);
    }
    std::uint64_t total() const {
        std::uint64_t sum = 0;
        for (const Shard& shard : shards_)
            sum += shard.value.load(std::memory_order_relaxed);
        return sum;
    }

  private:
    static constexpr unsigned kShards = 64;
    struct alignas(64) Shard {
        std::atomic<std::uint64_t> value{0};
    };
    std::array<Shard, kShards> shards_;
};

} // namespace kokage

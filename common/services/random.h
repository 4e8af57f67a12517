#pragma once
// Counter-based random numbers: the value depends on the key alone, so any thread can draw any of them in any order.
#include <cstdint>

namespace kokage {

/// A well-mixed 64-bit hash (the finaliser of SplitMix64, Steele et al. 2014).
inline std::uint64_t hash64(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// A small generator for one task, seeded by hashes (SplitMix64).
class Random {
  public:
    explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : state_(hash64(seed ^ hash64(stream))) {}
    std::uint64_t next() {
        state_ += 0x9e3779b97f4a7c15ull;
        std::uint64_t x = state_;
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
        return x ^ (x >> 31);
    }
    /// Uniform in [0, 1).
    float uniform() { return float(next() >> 40) * 0x1p-24f; }
    double uniform_double() { return double(next() >> 11) * 0x1p-53; }
    float uniform(float low, float high) { return low + (high - low) * uniform(); }
    /// Uniform in 0 … count-1.
    std::uint32_t below(std::uint32_t count) { return std::uint32_t((std::uint64_t(next() >> 32) * count) >> 32); }

  private:
    std::uint64_t state_;
};

} // namespace kokage

#pragma once
// The numbers that drive one path: the first dimensions from Owen-scrambled Sobol sequences, the deeper ones
// independent.
#include "common/services/random.h"
#include "common/types.h"

namespace kokage {

/// An Owen-scrambled (0,2)-sequence of points in [0, 1)^2: the `dimension`-th pair of the paths that share a seed.
class SobolPairs {
  public:
    explicit SobolPairs(std::uint64_t seed, int dimension = 0);
    /// Of hash64(seed).
    static SobolPairs of_hash(std::uint64_t hashed_seed, int dimension);
    glm::vec2 at(std::uint32_t index) const;

  private:
    struct Keys {
        std::uint64_t first, second;
    };
    explicit SobolPairs(const Keys& keys) : keys_(keys) {}
    Keys keys_;
};

/// Path `index` of a set of paths that share a seed. Its n-th pair, seen over indices 0, 1, 2, ..., is an
/// Owen-scrambled (0,2)-sequence of its own; pairs are shuffled against each other (padding). Sets with different seeds
/// are independent. Each number alone is uniform in [0, 1), so that estimates are unbiased for any count of paths.
class PathNumbers {
  public:
    PathNumbers(std::uint64_t seed, std::uint32_t index) : random_(seed, index), seed_(hash64(seed)), index_(index) {}
    /// Only independent numbers.
    explicit PathNumbers(Random& random) : random_(random.next()), dimension_(kSequences) {}

    float single();
    glm::vec2 pair();
    /// Leaves a dimension out that this path doesn't need, so that later ones keep their sequences.
    void skip() { dimension_ += dimension_ < kSequences; }
    /// An independent number; takes no dimension.
    float independent() { return random_.uniform(); }

  private:
    static constexpr int kSequences = 8; ///< beyond: independent numbers; deep bounces gain nothing from sequences
    Random random_;
    std::uint64_t seed_ = 0;
    std::uint32_t index_ = 0;
    int dimension_ = 0;
};

} // namespace kokage

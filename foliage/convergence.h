#pragma once
// Watching an iteration of light bounces: does it contract, when is it done, and what to tell the user.
#include "common/types.h"
#include "foliage/solution.h"

#include <optional>
#include <string>
#include <vector>

namespace kokage {

/// Largest change of any side and channel, and largest radiance, after one more bounce.
struct BounceChange {
    double largest_change = 0, largest_radiance = 0;
};
BounceChange compare_bounces(const SideRadiance& before, const SideRadiance& after);

class Convergence {
  public:
    /// `max_bounces` 0 = until the residual is below `residual`.
    Convergence(int max_bounces, double residual) : max_bounces_(max_bounces), residual_(residual) {}

    /// Takes in a bounce; true if another one is needed.
    bool another(const BounceChange& change);

    /// Per bounce: largest change over largest radiance.
    const std::vector<double>& residuals() const { return residuals_; }
    /// By what factor the largest change shrank per bounce, over the last bounces (up to 5); empty before the third
    /// bounce or when nothing changes any more. An estimate of the spectral radius: below 1, the iteration contracts.
    std::optional<double> rate() const;
    /// Changes that do not shrink over 5 bounces.
    bool diverges() const;
    /// One line for the report's warnings when the iteration does not contract or was stopped short; else empty.
    std::string warning() const;

  private:
    int max_bounces_;
    double residual_;
    std::vector<double> changes_, residuals_;
    bool stopped_short_ = false;
};

} // namespace kokage

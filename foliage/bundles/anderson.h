#pragma once
// Anderson acceleration of a linear fixed-point iteration x <- g(x), each colour channel on its own.
//
// From the last two steps' residuals f = g(x) - x it finds the combination that would have made the residual least, and
// moves there (Anderson 1965; on linear problems it is GMRES in other clothes). For a contraction it converges at least
// as fast as the plain iteration (Toth and Kelley 2015, Convergence Analysis for Anderson Acceleration, theorem 2.1).
#include "foliage/bundles/scattering.h"

#include <array>

namespace kokage::bundles {

class AndersonAcceleration {
  public:
    /// Of the sweeps so far, for scatter().
    SweepHistory history() const;
    /// Given x, g(x) and their products with the history, steps on: `x` becomes the next x, the old x and g(x) are
    /// kept, and `image` is left with room for the next g(x). Where hardly anything absorbs, the combination may land
    /// far below zero, and light never is negative: then the next x is g(x).
    void advance(std::vector<Rgb>& x, std::vector<Rgb>& image, const HistoryProducts& products);

  private:
    struct Sweep {
        std::vector<Rgb> read, made;
    };
    std::array<Sweep, 2> sweeps_; ///< newest first; empty until they exist
};

} // namespace kokage::bundles

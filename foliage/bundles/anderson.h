#pragma once
// Anderson acceleration of a linear fixed-point iteration x <- g(x), each colour channel on its own.
//
// From the last steps' residuals f = g(x) - x it finds the combination that would have made the residual least, and
// moves there (Anderson 1965; on linear problems it is GMRES in other clothes). For a contraction it converges at least
// as fast as the plain iteration (Toth and Kelley 2015, Convergence Analysis for Anderson Acceleration, theorem 2.1).
#include "foliage/bundles/bounce_sweeps.h"

#include <deque>

namespace kokage::bundles {

class AndersonAcceleration {
  public:
    explicit AndersonAcceleration(int depth) : depth_(depth) {}
    /// Given x and g(x), the next x.
    std::vector<Rgb> next(const std::vector<Rgb>& x, const std::vector<Rgb>& image);

  private:
    struct Step {
        std::vector<Rgb> residual_change, image_change;
        std::deque<glm::dvec3> products; ///< of residual_change with its own and earlier steps', newest first
    };
    int depth_;
    std::deque<Step> steps_;
    std::vector<Rgb> last_residual_, last_image_;
};

} // namespace kokage::bundles

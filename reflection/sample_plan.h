#pragma once
// How many camera rays each pixel gets: more where its first rays disagree. Private to reflection.
#include "reflection/film.h"

#include <vector>

namespace kokage {

/// A pixel's mean error falls with sigma / sqrt(N). The sum over all pixels is least, for so many rays in all, where N
/// is proportional to sigma^(2/3).
class SamplePlan {
  public:
    /// For pixels whose first rays spread like these (`spreads`, from all over the picture): `samples` rays a pixel in
    /// the mean, at least `first` and at most kMost times `samples` each.
    SamplePlan(const std::vector<double>& spreads, int samples, int first);

    /// Rays that are traced before one can tell: all, where there are few.
    static int first_samples(int samples);
    /// How many in all for this spread.
    int count(double spread) const;

  private:
    static constexpr int kMost = 8;
    double scale_ = 0;
    int first_, most_;
};

/// Standard deviation of a square's rays, the mean of the three channels.
double spread_of(const CameraSample* samples, std::size_t count);

} // namespace kokage

#pragma once
// How many camera rays each pixel gets: more where its first rays disagree. Private to reflection.
#include "reflection/film.h"

#include <vector>

namespace kokage {

/// How radiance varies among rays of a square, or of some squares: sums of squares about the squares' means, and about
/// the means of the parts that were met (all of which one ray alone met as one), over degrees of freedom.
struct RadianceSpread {
    static constexpr int kMostCoverageRays = 4;

    glm::dvec3 all{0.}, in_parts{0.};
    double all_freedom = 0, in_parts_freedom = 0;

    void add(const RadianceSpread& other);
    glm::dvec3 variance() const;
    /// As far as one can tell: where all rays met parts of their own, that of all.
    glm::dvec3 variance_in_parts() const;
    /// How many coverage rays (film.h) a shaded ray pay in a square whose neighbours spread so. (A square's own rays
    /// must have no say: those that happen to meet what is rare would call for more rays, those that don't would not,
    /// and the rare would lose.)
    int coverage_rays() const;
    /// Standard deviation, mean of the three channels, of a shaded ray with so many coverage rays, over what they all
    /// cost.
    double deviation(int coverage_rays) const;
};

RadianceSpread spread_of(std::span<const CameraSample> samples);

/// A pixel's mean error falls with sigma / sqrt(N). The sum over all pixels is least, for so many rays in all, where N
/// is proportional to sigma^(2/3), and where rays of a pixel cost c times as much, to (sigma / c)^(2/3).
class SamplePlan {
  public:
    /// For pixels whose rays spread like these (RadianceSpread::deviation, from all over the picture): `samples` rays a
    /// pixel in the mean, at least `first` and at most kMost times `samples` each.
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

} // namespace kokage

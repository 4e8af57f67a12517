#pragma once
#include "common/services/progress.h"
#include "common/trace/ray_queries.h"
#include "foliage/patch_points.h"
#include "foliage/solution.h"

#include <vector>

namespace kokage {

/// How much of what patches send out leaves the tree, measured by rays on a sample of the patches: an energy balance
/// that owes nothing to the method that it judges.
class OpenSky {
  public:
    OpenSky(const RayQueries& queries, std::uint64_t seed, Progress& progress);
    /// Power that leaves the tree, to the sky and to the ground, in luminance.
    double escaping_power(const SideRadiance& radiance) const;
    const std::vector<double>& areas() const { return points_.areas(); } ///< solid area of each patch in m^2
    std::uint64_t rays_traced() const { return rays_; }

  private:
    struct Sampled {
        std::uint32_t patch;
        float open_front, open_back; ///< share of the side's cosine-weighted hemisphere in which no patch is hit
    };
    PatchPoints points_;
    std::vector<Sampled> sampled_;
    std::uint64_t rays_ = 0;
};

} // namespace kokage

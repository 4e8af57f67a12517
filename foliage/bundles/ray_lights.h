#pragma once
// Distant lights on patches that are too small or too wide for beams (see ray_links.h): shadow rays, kept until the
// light moves.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/trace/ray_queries.h"
#include "foliage/bundles/bounce_sweeps.h"
#include "foliage/patch_points.h"

#include <vector>

namespace kokage::bundles {

class RayLights {
  public:
    /// All must outlive it.
    RayLights(const RayQueries& queries, const PatchPoints& points, const RayLinks& links);

    /// Starts a new sum over lights.
    void begin();
    /// Adds `scale` x a light, which gets `rays` shadow rays of each small leaf (at least 2 a half; of a wide patch
    /// RayLinks::kRaysOfWide times as many) if it is new or has become much more important than it was when it was
    /// traced. Throws Stopped.
    void add(const DistantLight& light, const glm::vec3& scale, int rays, std::uint64_t seed, Progress& progress);
    /// Writes the sum over what beams gave to those patches, and forgets lights that were not added.
    void finish(std::vector<Rgb> (&halves)[2]);
    void clear() { kept_.clear(); }

    std::uint64_t rays() const { return rays_; } ///< traced since begin()
    std::size_t bytes() const;

  private:
    struct Transfer {
        std::uint64_t shape = 0;
        glm::vec3 irradiance{0.f}; ///< of the light as it was traced
        int rays_a_half = 0;       ///< of a small leaf
        bool used = false;
        std::vector<glm::vec3> received; ///< irradiance; 4 i + 2 k + h as in RayLinks
    };
    Transfer trace(const DistantLight& light, int rays_a_half, std::uint64_t seed, Progress& progress) const;

    const RayQueries& queries_;
    const PatchPoints& points_;
    const RayLinks& links_;
    std::vector<Transfer> kept_;
    std::vector<glm::vec3> sum_;
    std::uint64_t rays_ = 0;
};

} // namespace kokage::bundles

#pragma once
// The truth for everything: unidirectional path tracing with all bounces, light sampling and multiple importance
// sampling.
#include "common/environment/environment.h"
#include "common/services/random.h"
#include "common/trace/ray_queries.h"

#include <memory>

namespace kokage {

struct PathTracerOptions {
    int max_bounces = 0; ///< 0 = all: paths end by Russian roulette alone
    int roulette_after =
        4; ///< bounces before roulette begins; survival = largest channel of the throughput, at most 0.99
};

/// Ready to trace: ray queries plus the environment's sampling tables. Thread-safe. Scene and environment must outlive
/// it.
class PathTracer {
  public:
    PathTracer(const RayQueries& queries, const Environment& environment, PathTracerOptions options = {});
    ~PathTracer();

    /// One sample of the irradiance on the side of `normal` at a point (the estimate's expectation is E in radiance x
    /// sr): one cosine-distributed path for the remainder and everything bounced, one light sample (MIS where both can
    /// find it).
    struct IrradianceSample {
        glm::vec3 total{0.f};
        glm::vec3 direct_from_lights{0.f}; ///< unscattered light of split-off lights
    };
    IrradianceSample sample_irradiance(const glm::vec3& point, const glm::vec3& normal, Random& random) const;

    /// One sample of the radiance that arrives at `origin` from `direction` (camera rays).
    glm::vec3 sample_radiance(const glm::vec3& origin, const glm::vec3& direction, Random& random) const;

    /// Rays traced so far, of all threads.
    std::uint64_t rays_traced() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace kokage

#pragma once
// The truth for everything: unidirectional path tracing with all bounces, light sampling and multiple importance
// sampling.
#include "common/environment/environment.h"
#include "common/trace/path_numbers.h"
#include "common/trace/ray_queries.h"

#include <memory>
#include <vector>

namespace kokage {

struct PathTracerOptions {
    /// Scatterings between light and receiver; 0 = all: paths end by Russian roulette alone.
    int max_bounces = 0;
    /// Scatterings before roulette begins. Survival follows the largest channel of the throughput, at most 0.99.
    int roulette_after = 0;
    /// Also draw directions towards the bright parts of the remainder, as often as its contrast asks for.
    bool sample_remainder = true;
    /// In place of the scene's, and as many; empty = the scene's.
    std::vector<Optics> optics;
};

/// Ready to trace: ray queries plus the environment's sampling tables. Thread-safe. Queries and environment must
/// outlive it. Patches are two-sided Lambertian; the ground is lit from above, and nothing arrives below it. Optics of
/// the scene are read when it is made.
class PathTracer {
  public:
    PathTracer(const RayQueries& queries, const Environment& environment, PathTracerOptions options = {});
    ~PathTracer();

    /// What a path met first.
    enum class Met : std::uint8_t {
        nothing, ///< there was no path: its direction lay below the surface's horizon, or the point below the ground
        sky,
        ground,
        patch
    };

    /// One sample of the irradiance on the side of `normal` at a point (its expectation is E in radiance x sr):
    /// one shadow ray to one light, and one path for the remainder and everything bounced.
    struct IrradianceSample {
        glm::vec3 total{0.f};
        glm::vec3 direct_from_lights{0.f}; ///< unscattered light of split-off lights
        glm::vec3 from_patches{0.f};       ///< light that arrives from patches (not from the ground)
        glm::vec3 path_direction{0.f};     ///< how the path left
        float path_weight = 0;             ///< cosine / (pi x density) of that direction: mean 1 over all paths
        Met first_met = Met::nothing;
    };
    IrradianceSample sample_irradiance(const glm::vec3& point, const glm::vec3& normal, PathNumbers& numbers) const;
    /// The same with independent numbers.
    IrradianceSample sample_irradiance(const glm::vec3& point, const glm::vec3& normal, Random& random) const;

    /// One sample of the radiance that arrives at `origin` from `direction` (camera rays). Split-off lights with an
    /// extent are seen as discs (or as their texels); bare directions and point lights are not seen.
    glm::vec3 sample_radiance(const glm::vec3& origin, const glm::vec3& direction, Random& random) const;

    /// Rays traced so far, of all threads.
    std::uint64_t rays_traced() const;

  private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace kokage

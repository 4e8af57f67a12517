#pragma once
// The radiance of the ground under a scene, where a camera ray meets it.
#include "reflection/ground_look.h"
#include "reflection/ground_sky_light.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

struct GroundRadiance {
    glm::vec3 total{0.f};
    glm::vec3 direct{0.f}; ///< of it, from split-off lights
    glm::vec3 albedo{0.f}; ///< 0 where the backdrop plays the ground
};

class GroundShading {
  public:
    /// All must outlive it.
    GroundShading(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                  const Backdrop& backdrop, const GroundLook& look, const LightChoice& lights, Progress& progress);

    /// Radiance of the ground at that distance (GroundLook::distance), towards the ray's origin. Black from below.
    GroundRadiance radiance(const glm::vec3& origin, const glm::vec3& direction, float distance, SampleIndex sample,
                            ShadingScratch& scratch) const;
    /// For rays that left the scene: of the mean soil, without air before it and without split-off lights
    /// in the backdrop, which are tested by themselves.
    glm::vec3 met_radiance(const glm::vec3& origin, const glm::vec3& direction, float distance, SampleIndex sample,
                           ShadingScratch& scratch) const;

  private:
    GroundRadiance diffuse_plane(const glm::vec3& point, const glm::vec3& direction, float distance, SampleIndex sample,
                                 ShadingScratch& scratch) const;
    /// `seen`: what the backdrop shows there.
    GroundRadiance shadowed_backdrop(const glm::vec3& point, const glm::vec3& seen, SampleIndex sample,
                                     ShadingScratch& scratch) const;
    GroundRadiance light_at(const glm::vec3& point, const glm::vec3& albedo, SampleIndex sample,
                            ShadingScratch& scratch) const;

    const RayQueries& queries_;
    const Backdrop& backdrop_;
    const GroundLook& look_;
    const LightChoice& lights_;
    std::optional<GroundSkyLight> light_;
    glm::vec3 backdrop_irradiance_{0.f}; ///< upwards, open: what lit the ground that the backdrop shows
};

} // namespace kokage

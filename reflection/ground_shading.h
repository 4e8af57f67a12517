#pragma once
// The radiance of the ground under a scene, where a camera ray meets it.
#include "reflection/backdrop_ground.h"
#include "reflection/ground_sky_light.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

struct GroundRadiance {
    glm::vec3 total{0.f};
    glm::vec3 direct{0.f}; ///< of it, from split-off lights
    glm::vec3 albedo{0.f}; ///< 0 where the backdrop plays the ground
};

/// A point of the ground before lights are tested there.
struct UnlitGround {
    glm::vec3 point{0.f};
    glm::vec3 total{0.f};       ///< radiance without split-off lights
    glm::vec3 by_light{0.f};    ///< times their light, scattered as `scattering` says: what it adds
    glm::vec3 reflectance{0.f}; ///< of the lights' light; black: none need be tested
    glm::vec3 albedo{0.f};

    Scattering scattering() const { return {{0, 1, 0}, reflectance, glm::vec3(0.f)}; }
    GroundRadiance lit(const glm::vec3& scattered) const {
        return {total + by_light * scattered, by_light * scattered, albedo};
    }
};

class GroundShading {
  public:
    /// All must outlive it.
    GroundShading(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                  const Backdrop& backdrop, const GroundLook& look, const LightChoice& lights, Progress& progress);

    /// The ground at that distance (GroundLook::distance), towards the ray's origin. Black from below.
    UnlitGround unlit(const glm::vec3& origin, const glm::vec3& direction, float distance) const;
    /// For rays that left the scene: of the mean soil, without air before it. `lights`: what a backdrop that plays the
    /// ground shows there of the split-off lights, unless they are tested by themselves.
    glm::vec3 met_radiance(const glm::vec3& origin, const glm::vec3& direction, float distance, const glm::vec3& lights,
                           SampleIndex sample, ShadingScratch& scratch) const;

  private:
    UnlitGround diffuse_plane(const glm::vec3& point, const glm::vec3& albedo) const;
    /// As BackdropGround::share().
    UnlitGround changed_backdrop(const glm::vec3& point, const glm::vec3& shown, const glm::vec3& lights) const;

    const RayQueries& queries_;
    const Backdrop& backdrop_;
    const GroundLook& look_;
    const LightChoice& lights_;
    std::optional<GroundSkyLight> light_;
    std::optional<BackdropGround> backdrop_ground_; ///< if the backdrop plays the ground
};

} // namespace kokage

#pragma once
// What a ray from a shaded point brings: solved radiance of the surface that it meets, or lit ground. Private to
// reflection.
#include "common/environment/environment.h"
#include "reflection/ground_look.h"
#include "reflection/ground_shading.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

class IncomingRadiance {
  public:
    /// All must outlive it.
    IncomingRadiance(const RayQueries& queries, const Environment& environment, const SurfaceShading& surfaces,
                     const GroundLook& ground, const GroundShading& ground_light)
        : queries_(queries), environment_(environment), surfaces_(surfaces), ground_(ground),
          ground_light_(ground_light) {}

    /// Empty where the ray leaves the scene.
    std::optional<glm::vec3> along(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample,
                                   ShadingScratch& scratch) const;
    /// Whether the ray leaves the scene.
    bool sees_sky(const glm::vec3& origin, const glm::vec3& direction, ShadingScratch& scratch) const;
    /// As along() for a ray that was drawn from a lobe of this roughness. Such rays show what they meet: smooth
    /// surfaces mirror their surroundings by further rays, in place of the solution's gloss, which knows their mean
    /// alone.
    std::optional<glm::vec3> through_lobe(const glm::vec3& origin, const glm::vec3& direction, float roughness,
                                          SampleIndex sample, ShadingScratch& scratch) const;

    float ray_offset() const { return queries_.ray_offset(); }
    /// Else the surroundings' lower half plays the ground.
    bool has_ground() const { return ground_.mean_albedo().has_value(); }
    /// From where on the ground hides surfaces from a ray; infinite if it doesn't meet it.
    float ground_distance(const glm::vec3& origin, const glm::vec3& direction) const {
        return ground_.distance_to_surfaces(ground_.distance(origin, direction), direction);
    }

  private:
    /// What a ray meets first: a surface, the ground, or nothing.
    struct Met {
        std::optional<SurfacePoint> surface;
        float ground_distance;
    };
    Met first_met(const glm::vec3& origin, const glm::vec3& direction, ShadingScratch& scratch) const;
    glm::vec3 surroundings(const glm::vec3& direction, float roughness) const;

    const RayQueries& queries_;
    const Environment& environment_;
    const SurfaceShading& surfaces_;
    const GroundLook& ground_;
    const GroundShading& ground_light_;
};

} // namespace kokage

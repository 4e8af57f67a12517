#pragma once
// What a ray from a shaded point brings: solved radiance of the surface that it meets, or lit ground. Private to
// reflection.
#include "reflection/ground_look.h"
#include "reflection/ground_shading.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

class IncomingRadiance {
  public:
    /// All must outlive it.
    IncomingRadiance(const RayQueries& queries, const SurfaceShading& surfaces, const GroundLook& ground,
                     const GroundShading& ground_light)
        : queries_(queries), surfaces_(surfaces), ground_(ground), ground_light_(ground_light) {}

    /// Empty where the ray leaves the scene.
    std::optional<glm::vec3> along(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample,
                                   ShadingScratch& scratch) const;

    float ray_offset() const { return queries_.ray_offset(); }
    /// Else the surroundings' lower half plays the ground.
    bool has_ground() const { return ground_.mean_albedo().has_value(); }
    /// From where on the ground hides surfaces from a ray; infinite if it doesn't meet it.
    float ground_distance(const glm::vec3& origin, const glm::vec3& direction) const {
        return ground_.distance_to_surfaces(ground_.distance(origin, direction), direction);
    }

  private:
    const RayQueries& queries_;
    const SurfaceShading& surfaces_;
    const GroundLook& ground_;
    const GroundShading& ground_light_;
};

} // namespace kokage

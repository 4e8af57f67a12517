#pragma once
// The ground under a scene as rays meet it: a level plane. Surfaces that lie in it lie on it; it is not left to
// rounding to show now the one and now the other.
#include "common/types.h"

namespace kokage {

class GroundPlane {
  public:
    /// `rounding_m`: of points that rays find in the scene (RayQueries::ray_offset).
    GroundPlane(float height_m, float rounding_m) : height_m_(height_m), rounding_m_(rounding_m) {}

    float height_m() const { return height_m_; }
    /// Distance at which a ray meets it; infinite if it doesn't. Rays that go up from no further below than rounding
    /// leave a surface that lies in it.
    float distance(const glm::vec3& origin, const glm::vec3& direction) const;
    /// A ray that meets the ground at `ground_distance` (infinite: not at all) is to look so far for surfaces: those
    /// that it meets before are on the ground.
    float distance_to_surfaces(float ground_distance, const glm::vec3& direction) const;

  private:
    float height_m_, rounding_m_;
};

} // namespace kokage

#pragma once
// Directions about an axis, to draw many from.
#include "common/types.h"

namespace kokage {

/// The directions within `half_angle` of a unit axis, as sample_cone() (environment.h) draws them.
class Cone {
  public:
    Cone(const glm::vec3& axis, float half_angle);
    /// Drawn uniformly in solid angle by two uniform numbers.
    glm::vec3 sample(float u0, float u1) const;

  private:
    glm::vec3 axis_, tangent_, bitangent_;
    float height_; ///< 1 - cos(half angle)
};

/// Of a disc of light that a surface faces: radiance over the density of Cone's directions, over its irradiance.
float radiance_over_density_of_disc(float half_angle);

} // namespace kokage

#pragma once
// Spherical harmonics of lights at infinity (spherical_harmonics.h).
#include "common/environment/environment.h"

#include <vector>

namespace kokage {

/// Radiance x solid angle of a uniform disc, for an irradiance of 1 on a surface that faces it: 1/cos²(a/2), beyond a
/// right angle 4 sin²(a/2). `half_angle` a in radians.
double flux_per_irradiance(double half_angle);

/// Coefficients of a light's radiance: of a disc exactly, of a region each texel as light from its direction alone.
std::vector<glm::vec3> project_light(const DistantLight& light, int bands);

} // namespace kokage

#pragma once
// Lights at infinity as a ray sees them.
#include "common/environment/environment.h"

namespace kokage {

/// Radiance of a light from `direction` (unit): a disc's all over it, of a region its pixels' cones. 0 beside it, and
/// of what has no extent.
glm::vec3 radiance_along(const DistantLight& light, const glm::vec3& direction);

} // namespace kokage

#pragma once
#include "common/types.h"

#include <cmath>

namespace kokage {

/// A direction that is told about +Y, about a unit `axis` instead: +Y becomes the axis, +X and +Z any right angles to
/// it and to each other. Unit. `Vector` is glm::vec3 or glm::dvec3.
template <typename Vector>
Vector about_axis(const Vector& direction, const Vector& axis) {
    using Value = typename Vector::value_type;
    const Vector helper = std::abs(axis.x) > Value(0.5) ? Vector(0, 1, 0) : Vector(1, 0, 0);
    const Vector tangent = glm::normalize(glm::cross(helper, axis)), bitangent = glm::cross(axis, tangent);
    return glm::normalize(direction.x * tangent + direction.z * bitangent + direction.y * axis);
}

} // namespace kokage

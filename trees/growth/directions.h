#pragma once
// Small helpers with directions.
#include "common/services/random.h"
#include "common/types.h"

#include <cmath>

namespace kokage {

/// The vector scaled to length 1; `otherwise` if it has no length.
inline glm::vec3 unit_or(const glm::vec3& v, const glm::vec3& otherwise) {
    const float length = glm::length(v);
    return length > 1e-20f ? v / length : otherwise;
}

/// Some unit vector at right angles to a unit vector.
inline glm::vec3 any_perpendicular(const glm::vec3& unit) {
    const glm::vec3 other = std::abs(unit.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    return glm::normalize(glm::cross(unit, other));
}

/// A unit vector at `angle` radians from `axis` (unit), at `azimuth` around it.
inline glm::vec3 tilted(const glm::vec3& axis, float angle, float azimuth) {
    const glm::vec3 x = any_perpendicular(axis), y = glm::cross(axis, x);
    return std::cos(angle) * axis + std::sin(angle) * (std::cos(azimuth) * x + std::sin(azimuth) * y);
}

/// Uniform on the sphere.
inline glm::vec3 random_direction(Random& random) {
    const float y = random.uniform(-1.f, 1.f), azimuth = random.uniform(0.f, 2 * kPi),
                r = std::sqrt(std::max(0.f, 1 - y * y));
    return {r * std::cos(azimuth), y, r * std::sin(azimuth)};
}

inline float radians(double degrees) {
    return float(degrees * kPiDouble / 180);
}

} // namespace kokage

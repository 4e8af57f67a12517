#pragma once
#include "common/types.h"

#include <algorithm>
#include <cmath>

namespace kokage {

/// A direction of the hemisphere around a unit normal, distributed as its cosine, from two uniform numbers.
inline glm::vec3 cosine_direction(const glm::vec3& normal, const glm::vec2& numbers) {
    const glm::vec3 helper = std::abs(normal.x) > 0.5f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 tangent = glm::normalize(glm::cross(helper, normal)), bitangent = glm::cross(normal, tangent);
    const float radius = std::sqrt(numbers.x), azimuth = 2 * kPi * numbers.y;
    const float height = std::sqrt(std::max(0.f, 1 - numbers.x));
    return glm::normalize(radius * std::cos(azimuth) * tangent + radius * std::sin(azimuth) * bitangent +
                          height * normal);
}

} // namespace kokage

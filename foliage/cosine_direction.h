#pragma once
#include "common/directions/about_axis.h"

#include <algorithm>
#include <cmath>

namespace kokage {

/// A direction of the hemisphere around a unit normal, distributed as its cosine, from two uniform numbers.
inline glm::vec3 cosine_direction(const glm::vec3& normal, const glm::vec2& numbers) {
    const float radius = std::sqrt(numbers.x), azimuth = 2 * kPi * numbers.y;
    const float height = std::sqrt(std::max(0.f, 1 - numbers.x));
    return about_axis(glm::vec3(radius * std::cos(azimuth), height, radius * std::sin(azimuth)), normal);
}

} // namespace kokage

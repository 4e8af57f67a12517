#pragma once
#include "common/types.h"

#include <cmath>

namespace kokage {

/// A position rounded to 2^-18 m (4 micrometres), so that the last bit of a double, which may differ between machines
/// that fuse multiplications and additions and those that don't, leaves no trace.
inline glm::vec3 rounded(const glm::dvec3& position) {
    constexpr double steps = 262144.0;
    return {float(std::round(position.x * steps) / steps), float(std::round(position.y * steps) / steps),
            float(std::round(position.z * steps) / steps)};
}

} // namespace kokage

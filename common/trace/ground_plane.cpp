#include "common/trace/ground_plane.h"

#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Of a ray's length: how far its end may be off by rounding, with some to spare.
constexpr float kRoundingOfLength = 0x1p-20f;

} // namespace

float GroundPlane::distance(const glm::vec3& origin, const glm::vec3& direction) const {
    if (direction.y > 0 && !(origin.y < height_m_ - rounding_m_))
        return kInfinity;
    const float distance = (height_m_ - origin.y) / direction.y;
    return distance > 0 && std::isfinite(distance) ? distance : kInfinity;
}

float GroundPlane::distance_to_surfaces(float ground_distance, const glm::vec3& direction) const {
    return ground_distance + (rounding_m_ + kRoundingOfLength * ground_distance) / std::abs(direction.y);
}

} // namespace kokage

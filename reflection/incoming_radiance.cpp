#include "reflection/incoming_radiance.h"

#include <limits>

namespace kokage {

std::optional<glm::vec3> IncomingRadiance::along(const glm::vec3& origin, const glm::vec3& direction,
                                                 SampleIndex sample, ShadingScratch& scratch) const {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    ++scratch.met_rays;
    RayHit hit;
    const float ground_distance = ground_.distance(origin, direction);
    const float hidden_from = ground_.distance_to_surfaces(ground_distance, direction);
    if (queries_.first_hit(origin, direction, queries_.ray_offset(), hidden_from, hit) && !hit.ground)
        return surfaces_.met_radiance(surfaces_.point(origin, direction, hit), direction, sample, scratch);
    if (ground_distance < kInfinity)
        return ground_light_.met_radiance(origin, direction, ground_distance, sample, scratch);
    return std::nullopt;
}

} // namespace kokage

#pragma once
// Capturing light-environment maps: what is seen from a point in every direction. No light in it, so it is done once;
// the radiance of what is seen is put in afterwards, as often as it changes.
#include "common/services/progress.h"
#include "common/trace/ray_queries.h"
#include "foliage/capture_directions.h"
#include "foliage/ground_cells.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace kokage {

/// A point that looks around. Rays start `clearance_m` away from it, outside of the wood that holds a branching point.
struct CapturePoint {
    glm::vec3 position{0.f};
    float clearance_m = 0;
};

/// What a capture ray sees: 2 patch (its front), 2 patch + 1 (its back), 2 patch_count + cell (the ground), or nothing
/// but sky.
inline constexpr std::uint32_t kSeesSky = 0xffffffffu;

struct Capture {
    std::size_t direction_count = 0;
    std::vector<std::uint32_t> seen; ///< point by point, direction by direction
    std::vector<float> distances;    ///< metres from the point, likewise; infinite where sky is seen

    std::span<const std::uint32_t> seen_from(std::size_t point) const {
        return {seen.data() + point * direction_count, direction_count};
    }
    std::span<const float> distances_from(std::size_t point) const {
        return {distances.data() + point * direction_count, direction_count};
    }
};

/// Traces one ray per point and direction. Alpha-masked holes let rays through. Throws Stopped.
Capture capture(const RayQueries& queries, const GroundCells& ground, std::span<const CapturePoint> points,
                std::span<const glm::vec3> directions, Progress& progress);

/// First hit in (clearance, far) of a ray from a point that may stand inside wood. Bark is closed, so a ray that meets
/// the back of bark has started inside it, and goes on.
bool first_hit_outside_wood(const RayQueries& queries, const CapturePoint& point, const glm::vec3& direction, float far,
                            RayHit& hit);

} // namespace kokage

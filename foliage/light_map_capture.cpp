#include "foliage/light_map_capture.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr int kMostBarkLayers = 32; // wood inside wood, where branches join; a bound only against broken meshes

bool on_back_of_bark(const PatchScene& scene, const RayHit& hit, const glm::vec3& direction) {
    return !hit.ground && scene.patches[scene.triangle_patch[hit.triangle]].kind == PatchKind::bark &&
           glm::dot(hit.geometric_normal, direction) > 0;
}

std::uint32_t what_is_seen(const PatchScene& scene, const GroundCells& ground, const CapturePoint& point,
                           const glm::vec3& direction, const RayHit& hit) {
    if (hit.ground)
        return std::uint32_t(2 * scene.patches.size() + ground.cell(point.position + hit.distance * direction));
    const bool front = glm::dot(hit.geometric_normal, direction) < 0;
    return 2 * scene.triangle_patch[hit.triangle] + (front ? 0u : 1u);
}

} // namespace

bool first_hit_outside_wood(const RayQueries& queries, const CapturePoint& point, const glm::vec3& direction, float far,
                            RayHit& hit) {
    float near = std::max(point.clearance_m, queries.ray_offset());
    for (int layer = 0; queries.first_hit(point.position, direction, near, far, hit); ++layer) {
        if (layer == kMostBarkLayers || !on_back_of_bark(queries.scene(), hit, direction))
            return true;
        near = std::max(hit.distance + queries.ray_offset(), std::nextafter(hit.distance, far));
    }
    return false;
}

Capture capture(const RayQueries& queries, const GroundCells& ground, std::span<const CapturePoint> points,
                std::span<const glm::vec3> directions, Progress& progress) {
    constexpr float kFar = std::numeric_limits<float>::infinity();
    Capture result;
    result.direction_count = directions.size();
    result.seen.assign(points.size() * directions.size(), kSeesSky);
    result.distances.assign(points.size() * directions.size(), kFar);
    progress.begin("capturing light maps", points.size());
    parallel_blocks(points.size(), 1, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t p = begin; p < end; ++p)
            for (std::size_t k = 0; k < directions.size(); ++k) {
                RayHit hit;
                if (!first_hit_outside_wood(queries, points[p], directions[k], kFar, hit))
                    continue;
                const std::size_t at = p * directions.size() + k;
                result.seen[at] = what_is_seen(queries.scene(), ground, points[p], directions[k], hit);
                result.distances[at] = hit.distance;
            }
        progress.advance(end - begin);
    });
    return result;
}

} // namespace kokage

#include "foliage/bundles/point_beams.h"

#include "common/services/parallel.h"
#include "foliage/patch_points.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace kokage::bundles {
namespace {

/// Irradiance of a visible lamp of intensity 1 on a surface, signed: positive on the side of the normal.
float lamp_irradiance(const RayQueries& queries, const glm::vec3& position, const glm::vec3& point,
                      const glm::vec3& normal) {
    const glm::vec3 to_lamp = position - point;
    const float offset = queries.ray_offset(), distance = std::max(glm::length(to_lamp), offset);
    const glm::vec3 direction = to_lamp / distance;
    const float cosine = glm::dot(normal, direction);
    if (cosine == 0 || (distance > 2 * offset && queries.occluded(point, direction, offset, distance - offset)))
        return 0;
    return cosine / (distance * distance);
}

} // namespace

PointTransfer trace_point_light(const RayQueries& queries, const Facets& facets,
                                const std::optional<GroundGrid>& ground, const glm::vec3& position, int samples,
                                std::uint64_t seed) {
    const PatchScene& scene = queries.scene();
    const PatchPoints points(scene);
    const int half = std::max(1, (samples + 1) / 2);
    PointTransfer transfer;
    transfer.position = position;
    for (auto& sides : transfer.halves)
        sides.assign(scene.patches.size(), glm::vec2(0.f));
    parallel_blocks(scene.patches.size(), 1024, [&](std::size_t from, std::size_t to) {
        for (std::size_t patch = from; patch < to; ++patch)
            for (int h = 0; h < 2; ++h)
                for (int i = 0; i < half; ++i) {
                    PathNumbers numbers(hash64(seed + std::uint64_t(h)) ^ patch, std::uint32_t(i));
                    PatchPoint point;
                    if (!points.sample(std::uint32_t(patch), numbers, point))
                        continue;
                    const float irradiance =
                        lamp_irradiance(queries, position, point.position, point.normal) / float(half);
                    (irradiance > 0 ? transfer.halves[h][patch].x : transfer.halves[h][patch].y) +=
                        std::abs(irradiance);
                }
    });
    transfer.rays = 2ull * std::uint64_t(half) * scene.patches.size();
    if (!ground)
        return transfer;
    transfer.ground.assign(ground->texels(), 0.f);
    for (std::uint32_t texel = 0; texel < ground->texels(); ++texel) {
        const glm::vec2 centre = ground->centre_of(texel);
        const glm::vec3 point(glm::dvec3(centre.x, ground->height, centre.y) / facets.scale + facets.centre);
        const float irradiance = lamp_irradiance(queries, position, point, glm::vec3(0, 1, 0));
        transfer.ground[texel] = std::max(irradiance, 0.f);
    }
    return transfer;
}

} // namespace kokage::bundles

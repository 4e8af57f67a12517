#pragma once
// Point lights: parallel rasters can't see them, so each patch sends rays to them from stratified points.
#include "common/environment/environment.h"
#include "common/trace/ray_queries.h"
#include "foliage/bundles/bounce_sweeps.h"

#include <vector>

namespace kokage::bundles {

/// What a point light of intensity 1 gives to every side and ground texel, kept until it moves. Both halves hold the
/// whole light.
struct PointTransfer {
    glm::vec3 position{0.f};
    std::vector<glm::vec2> halves[2]; ///< per patch: irradiance of front and back, 1/m^2
    std::vector<float> ground;        ///< per texel
    std::uint64_t rays = 0;
};

/// `samples` rays a patch, at least 2. Distances below the scene's ray offset count as that, so that a lamp on a leaf
/// stays finite.
PointTransfer trace_point_light(const RayQueries& queries, const Facets& facets,
                                const std::optional<GroundGrid>& ground, const glm::vec3& position, int samples,
                                std::uint64_t seed);

} // namespace kokage::bundles

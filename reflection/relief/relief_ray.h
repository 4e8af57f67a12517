#pragma once
// Rays in relief space, where a tile is 1 x 1 and its relief 1 deep: (u, v, depth).
#include "reflection/relief/height_field.h"

#include <cstdint>
#include <limits>

namespace kokage {

/// The point at t >= 0 is origin + t direction. `origin.z` < 0 is above the reference plane: the ray goes on from where
/// it passes depth 0. Directions need no unit length; zero and denormal components are allowed. Texture coordinates may
/// lie many tiles away: tracers reduce them to one tile first.
struct ReliefRay {
    glm::vec3 origin{0.f};                                 ///< u, v, depth
    glm::vec3 direction{0, 0, 1};                          ///< du, dv, ddepth: + is downwards
    float t_most = std::numeric_limits<float>::infinity(); ///< hits beyond do not count
};

/// A ray that crosses more tiles than this along u or v, from where it passes depth 0, without a hit hits nothing (only
/// rays that are very nearly parallel to the surface do).
inline constexpr float kMostTilesCrossed = 1024;

/// First hit: the least t >= 0 at which the ray is not above the surface. A ray that starts below the surface hits at
/// t = 0. A ray that leaves upwards through depth 0, that passes t_most or that is not finite hits nothing. Nor does
/// one that gets nowhere (direction 0) from above the surface, or whose t of the hit no float can hold.
struct ReliefHit {
    float t = std::numeric_limits<float>::infinity(); ///< infinity: nothing was hit, and the rest means nothing
    glm::vec2 coordinate{0.f};                        ///< u, v; for a repeated tile within [0, 1)
    float depth = 0;
    glm::vec2 slope{0.f}; ///< ∂depth/∂u, ∂depth/∂v of the bilinear cell at the hit, per tile
    std::uint32_t reads =
        0; ///< of memory: one bound of a hierarchy, one stored depth, or one 2 x 2 cell of depths each

    bool found() const { return t < std::numeric_limits<float>::infinity(); }
};

/// A ray from a surface's tangent frame (tangent along +u, bitangent along +v, normal outwards), `direction` of unit
/// length in metres; t then counts in units of scale.depth_m. With depth_m = 0 rays go straight down: a flat surface.
inline ReliefRay relief_ray(const glm::vec2& coordinate, const glm::vec3& direction, const ReliefScale& scale,
                            float depth = 0) {
    const glm::vec2 across = glm::vec2(direction) * scale.depth_m / scale.tile_m;
    return {{coordinate, depth}, {across, -direction.z}};
}

/// How far rays towards a light start above the surface that they come from, in depth, so that rounding does not shade
/// it.
inline constexpr float kShadowLift = 1e-4f;

/// From a hit towards a light; `to_light` of unit length in the tangent frame.
inline ReliefRay relief_shadow_ray(const ReliefHit& hit, const glm::vec3& to_light, const ReliefScale& scale) {
    return relief_ray(hit.coordinate, to_light, scale, hit.depth - kShadowLift);
}

/// Unit normal in the tangent frame (tangent, bitangent, normal).
inline glm::vec3 relief_normal(const glm::vec2& slope, const ReliefScale& scale) {
    return glm::normalize(glm::vec3(slope * scale.depth_m / scale.tile_m, 1.f));
}

} // namespace kokage

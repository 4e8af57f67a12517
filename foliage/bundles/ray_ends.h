#pragma once
// Light from where the rays of small leaves end: sky and ground. Each call replaces what lines found for those leaves.
#include "foliage/bundles/outside_light.h"

#include <span>

namespace kokage::bundles {

/// Sky, and ground as if it lay open, in both halves and in all. `ground_radiance` is read with a ground only.
void gather_ray_ends(const BundleTransport& transport, const Image& remainder, const glm::vec3& ground_radiance,
                     SkyLight& sky);

/// Mean over each side's rays to the ground of what a texel sends beyond open ground; nothing beyond the grid.
void gather_ray_ground(const RayLinks& rays, std::span<const glm::vec3> ground_excess, std::span<Rgb> from_ground);

/// Sums of the directions in which both sides of the patches see the sky, in units of the patch's area.
void sum_ray_open_directions(const RayLinks& rays, const Facets& facets, std::span<glm::vec3> sums);

} // namespace kokage::bundles

#pragma once
// What arrives at every side from the sky (the environment without its lights), through the ends of lines.
#include "common/environment/environment.h"
#include "foliage/bundles/bounce_sweeps.h"
#include "foliage/bundles/bundle_tracing.h"

namespace kokage::bundles {

/// The same light estimated from the first half of the directions, from the second, and from all.
struct SkyLight {
    using PerSide = SideLight;
    PerSide halves[2], all;
    glm::vec3 open_ground_irradiance{0.f}; ///< of the upper hemisphere's remainder
    std::vector<glm::vec3> near_radiance;  ///< per link direction
};

/// `light_on_open_ground`: irradiance of ground that lies open by lights, which far ends see reflected.
SkyLight gather_sky(const PatchScene& scene, const Facets& facets, const BundleTransport& transport,
                    const Image& remainder, const glm::vec3& light_on_open_ground);

/// What the sky gives of it, from all directions; a ground is black, and its share of the sides is `down`.
SideLight gather_sky_alone(const Facets& facets, const BundleTransport& transport, const Image& remainder);

/// Mean open direction of both sides of every patch together (a bent normal), where a ground is not open; unit, or 0
/// where all is shut or the sides balance.
std::vector<glm::vec3> mean_open_directions(const Facets& facets, const BundleTransport& transport);

/// Irradiance of an open, horizontal ground by the image's upper half.
glm::vec3 horizontal_irradiance(const Image& remainder);

} // namespace kokage::bundles

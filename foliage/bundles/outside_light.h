#pragma once
// What arrives at every side from outside the tree: sky through the ends of lines, lights along beams.
#include "common/environment/environment.h"
#include "foliage/bundles/bounce_sweeps.h"
#include "foliage/bundles/bundle_tracing.h"
#include "foliage/bundles/light_beams.h"

#include <array>

namespace kokage::bundles {

/// The same light estimated from the first half of the directions, from the second, and from all.
struct SkyLight {
    struct PerSide {
        std::vector<Rgb> irradiance;
        std::vector<float> open, down;
    };
    PerSide halves[2], all;
    std::vector<glm::vec3> mean_open_direction; ///< per patch, both sides together; not normalised
    glm::vec3 open_ground_irradiance{0.f};      ///< of the upper hemisphere's remainder
    std::vector<glm::vec3> near_radiance;       ///< per link direction
};

/// `open_ground_radiance`: what far ends see when the scene has a ground.
SkyLight gather_sky(const PatchScene& scene, const Facets& facets, const BundleTransport& transport,
                    const Image& remainder, const glm::vec3& light_on_open_ground);

/// One light's visibility, kept until the light moves.
struct LitBeams {
    std::vector<Beam> beams;
    BeamVisibility visibility;
};

/// Adds a light's irradiance to the sides: to `halves` (each the whole light) and, averaged, to `all`.
struct BeamLight {
    std::vector<Rgb> halves[2];
    std::vector<glm::vec3> ground; ///< per texel, with shadows
    glm::vec3 open_ground{0.f};
};
void add_beams(const Facets& facets, const LitBeams& light, BeamLight& sum);

/// Irradiance of an open, horizontal ground by the image's upper half.
glm::vec3 horizontal_irradiance(const Image& remainder);

} // namespace kokage::bundles

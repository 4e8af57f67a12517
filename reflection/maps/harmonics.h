#pragma once
// Surroundings as a few spherical harmonics (common/directions/spherical_harmonics.h): what programs light diffuse
// surfaces by.
#include "common/environment/environment.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

enum class HarmonicQuantity {
    radiance,   ///< what arrives from a direction
    irradiance, ///< what a surface with that normal receives: radiance through the clamped cosine, pi times a grey
                ///< sky's
};
std::string_view harmonic_quantity_name(HarmonicQuantity quantity);  ///< "radiance", "irradiance"
HarmonicQuantity harmonic_quantity_from_name(std::string_view name); ///< throws InputError that lists them

struct HarmonicsSettings {
    static constexpr int most_bands = 512;
    /// Of irradiance, 3 bands (nine coefficients) are what engines use: Ramamoorthi and Hanrahan 2001, mean error 1 %.
    int bands = 3;
    HarmonicQuantity quantity = HarmonicQuantity::radiance;
    /// false: all light is in the coefficients. true: lights (bright regions of the image, split_lights.h, and those
    /// that were added) are listed beside them, and the coefficients are of what remains: then a sun neither rings in
    /// the coefficients nor is smoothed by them.
    bool list_lights = false;
};

struct Harmonics {
    HarmonicQuantity quantity = HarmonicQuantity::radiance;
    std::vector<glm::vec3> coefficients; ///< bands² of them, index l(l+1)+m; radiance as in the image, or times sr
    struct Light {
        std::string name;
        glm::vec3 direction{0, 1, 0}; ///< towards it; of a region its middle
        float half_angle = 0;         ///< radians: of the disc, or of a cone around the region
        glm::vec3 irradiance{0.f};    ///< on a surface that faces it
    };
    std::vector<Light> lights;

    int bands() const;
    /// The sum over the coefficients in a unit direction and, of irradiance, over the lights above the horizon, each
    /// as from its direction alone. Lights are not part of radiance: they are seen where they are.
    glm::vec3 value(const glm::vec3& direction) const;
};

/// `surroundings` are not split (EnvironmentLoading::split = false). Pixels are patches of constant radiance, lights
/// that were added are discs; point lights are left out. The same bits with any number of threads. Throws InputError
/// for bands out of range.
Harmonics harmonics_of(const Environment& surroundings, const HarmonicsSettings& settings = {});

} // namespace kokage

#include "reflection/maps/harmonics.h"

#include "common/directions/lobes.h"
#include "common/directions/projection.h"
#include "common/directions/zonal.h"
#include "common/environment/light_harmonics.h"
#include "common/environment/split_lights.h"
#include "common/services/error.h"

#include <algorithm>

namespace kokage {
namespace {

Harmonics::Light listed(const DistantLight& light) {
    return {light.name, light.direction, light.half_angle, light.irradiance};
}

} // namespace

std::string_view harmonic_quantity_name(HarmonicQuantity quantity) {
    return quantity == HarmonicQuantity::radiance ? "radiance" : "irradiance";
}

HarmonicQuantity harmonic_quantity_from_name(std::string_view name) {
    for (const HarmonicQuantity quantity : {HarmonicQuantity::radiance, HarmonicQuantity::irradiance})
        if (harmonic_quantity_name(quantity) == name)
            return quantity;
    throw InputError("harmonics of '" + std::string(name) + "' are not known; there are: radiance, irradiance");
}

int Harmonics::bands() const {
    return sh_bands(coefficients.size());
}

glm::vec3 Harmonics::value(const glm::vec3& direction) const {
    glm::vec3 sum = sh_radiance(coefficients, direction);
    if (quantity == HarmonicQuantity::irradiance)
        for (const Light& light : lights)
            sum += std::max(glm::dot(light.direction, direction), 0.f) * light.irradiance;
    return sum;
}

Harmonics harmonics_of(const Environment& surroundings, const HarmonicsSettings& settings) {
    if (settings.bands < 1 || settings.bands > HarmonicsSettings::most_bands)
        throw InputError("harmonics of " + std::to_string(settings.bands) + " bands: give 1 to " +
                         std::to_string(HarmonicsSettings::most_bands));
    Harmonics result;
    result.quantity = settings.quantity;
    if (settings.list_lights) {
        const LightSplit split = split_lights(surroundings.remainder);
        result.coefficients = project_lat_long(split.remainder, settings.bands);
        for (const std::vector<DistantLight>* lights : {&split.lights, &surroundings.distant_lights})
            for (const DistantLight& light : *lights)
                result.lights.push_back(listed(light));
    } else {
        result.coefficients = project_lat_long(surroundings.remainder, settings.bands);
        for (const DistantLight& light : surroundings.distant_lights) {
            const std::vector<glm::vec3> projected = project_light(light, settings.bands);
            for (std::size_t i = 0; i < projected.size(); ++i)
                result.coefficients[i] += projected[i];
        }
    }
    if (settings.quantity == HarmonicQuantity::irradiance)
        convolve_zonal(std::span(result.coefficients), std::span<const double>(cosine_lobe(settings.bands)));
    return result;
}

} // namespace kokage

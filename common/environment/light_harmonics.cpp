#include "common/environment/light_harmonics.h"
#include "common/directions/lobes.h"
#include "common/directions/zonal.h"

#include <cmath>

namespace kokage {

// Irradiance of a disc of radiance 1: pi sin²(a), beyond a right angle pi. Solid angle: 4 pi sin²(a/2). sin(a) = 2
// sin(a/2) cos(a/2).
double flux_per_irradiance(double half_angle) {
    const double half_cosine = std::cos(0.5 * half_angle), squared = half_cosine * half_cosine;
    return half_angle <= kPiDouble / 2 ? 1 / squared : 4 * (1 - squared);
}

std::vector<glm::vec3> project_light(const DistantLight& light, int bands) {
    std::vector<glm::vec3> coefficients(sh_count(bands), glm::vec3(0.f));
    if (light.texels.empty())
        add_zonal(coefficients, light.direction,
                  light.irradiance * float(flux_per_irradiance(double(light.half_angle))),
                  cone_lobe(bands, light.half_angle));
    for (const DistantLight::Texel& texel : light.texels) // radiance x solid angle: already a flux
        add_zonal(coefficients, texel.direction, texel.irradiance, std::vector<double>(std::size_t(bands), 1.0));
    return coefficients;
}

} // namespace kokage

#include "common/environment/light_radiance.h"

#include <cmath>

namespace kokage {
namespace {

bool is_within(const glm::vec3& direction, const glm::vec3& towards, float half_angle) {
    return half_angle > 0 && glm::dot(direction, towards) >= std::cos(half_angle);
}

/// A uniform cone of radiance L gives L pi sin^2(half angle) on a facing surface.
float irradiance_of_cone(float half_angle) {
    return kPi * std::sin(half_angle) * std::sin(half_angle);
}

} // namespace

glm::vec3 radiance_along(const DistantLight& light, const glm::vec3& direction) {
    if (!is_within(direction, light.direction, light.half_angle))
        return glm::vec3(0.f);
    if (light.texels.empty())
        return light.irradiance / irradiance_of_cone(light.half_angle);
    glm::vec3 seen(0.f);
    for (const DistantLight::Texel& texel : light.texels)
        if (is_within(direction, texel.direction, texel.half_angle))
            seen += texel.irradiance / irradiance_of_cone(texel.half_angle);
    return seen;
}

} // namespace kokage

#include "common/environment/cone.h"
#include "common/environment/environment.h"

#include <algorithm>
#include <cmath>

namespace kokage {

// Works with 1 - cos, so that a sun of 0.27 degrees does not drown in rounding.
Cone::Cone(const glm::vec3& axis, float half_angle) : axis_(axis) {
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3.
    const float sign = std::copysign(1.f, axis.z), a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
    tangent_ = {1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
    bitangent_ = {b, sign + axis.y * axis.y * a, -axis.y};
    const float half_sine = std::sin(0.5f * std::clamp(half_angle, 0.f, kPi));
    height_ = 2 * half_sine * half_sine;
}

glm::vec3 Cone::sample(float u0, float u1) const {
    if (!(height_ > 0))
        return axis_;
    const float height = u0 * height_; // 1 - cos(theta)
    const float radius = std::sqrt(std::max(0.f, height * (2 - height))), phi = 2 * kPi * u1;
    return glm::normalize((1 - height) * axis_ + radius * (std::cos(phi) * tangent_ + std::sin(phi) * bitangent_));
}

glm::vec3 sample_cone(const glm::vec3& axis, float half_angle, float u0, float u1) {
    return Cone(axis, half_angle).sample(u0, u1);
}

/// Radiance L within half angle a gives a facing surface L pi sin^2(a) (beyond a right angle L pi); L over the density
/// is L 2 pi (1 - cos(a)). Their ratio is 1/cos^2(a/2) (beyond: 2 (1 - cos(a))).
float radiance_over_density_of_disc(float half_angle) {
    const float half_cosine = std::cos(0.5f * half_angle), squared = half_cosine * half_cosine;
    return half_angle <= kPi / 2 ? 1 / squared : 4 * (1 - squared);
}

LightSample sample_light(const DistantLight& light, float u0, float u1) {
    if (light.texels.empty())
        return {sample_cone(light.direction, light.half_angle, u0, u1),
                light.irradiance * radiance_over_density_of_disc(light.half_angle)};
    double total = 0;
    for (const DistantLight::Texel& texel : light.texels)
        total += luminance(texel.irradiance);
    // All of it black, or below what float can tell from black: every texel alike.
    const double count = double(light.texels.size());
    auto share = [&](const DistantLight::Texel& texel) {
        return total > 0 ? luminance(texel.irradiance) / total : 1 / count;
    };
    double left = u0;
    std::size_t chosen = 0, last_possible = 0;
    for (;; ++chosen) {
        if (chosen == light.texels.size()) { // rounding of the shares' sum
            chosen = last_possible;
            left = 0.5 * share(light.texels[chosen]);
            break;
        }
        const double probability = share(light.texels[chosen]);
        if (left < probability)
            break;
        left -= probability;
        if (probability > 0)
            last_possible = chosen;
    }
    const DistantLight::Texel& texel = light.texels[chosen];
    const double probability = share(texel);
    const float rest = std::min(float(left / probability), 0x1.fffffep-1f);
    return {sample_cone(texel.direction, texel.half_angle, rest, u1),
            glm::vec3(glm::dvec3(texel.irradiance) / probability)};
}

} // namespace kokage

#include "reflection/ground_shading.h"

#include <algorithm>
#include <cmath>

namespace kokage {
GroundShading::GroundShading(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                             const Backdrop& backdrop, const GroundLook& look, const LightChoice& lights,
                             Progress& progress)
    : queries_(queries), backdrop_(backdrop), look_(look), lights_(lights) {
    if (!look.height())
        return;
    light_.emplace(scene, queries, backdrop, *look.height(), progress);
    backdrop_irradiance_ = light_->open_irradiance();
    for (const DistantLight& light : environment.distant_lights)
        for (const DistantLight::Texel& texel : light.texels)
            backdrop_irradiance_ += texel.irradiance * std::max(0.f, texel.direction.y);
}

UnlitGround GroundShading::unlit(const glm::vec3& origin, const glm::vec3& direction, float distance) const {
    if (direction.y >= 0)
        return {};
    const glm::vec3 point = look_.point(origin, direction, distance);
    if (!look_.mean_albedo())
        return shadowed_backdrop(point, backdrop_.seen(direction));
    // The plane of an exact model ends in a hard line at the horizon; air softens it towards the sky just above.
    const float clear = look_.clear(distance);
    UnlitGround ground;
    if (clear > 1e-4f)
        ground = diffuse_plane(point, look_.albedo(point, direction, distance));
    ground.total = clear * ground.total + (1 - clear) * look_.haze(direction);
    ground.by_light *= clear;
    return ground;
}

glm::vec3 GroundShading::met_radiance(const glm::vec3& origin, const glm::vec3& direction, float distance,
                                      SampleIndex sample, ShadingScratch& scratch) const {
    if (direction.y >= 0)
        return glm::vec3(0.f);
    const glm::vec3 point = look_.point(origin, direction, distance);
    const UnlitGround ground = look_.mean_albedo() ? diffuse_plane(point, *look_.mean_albedo())
                                                   : shadowed_backdrop(point, backdrop_.remainder(direction));
    return ground.lit(light_from_lights(lights_, queries_, point, ground.scattering(), sample, scratch).scattered)
        .total;
}

UnlitGround GroundShading::diffuse_plane(const glm::vec3& point, const glm::vec3& albedo) const {
    return {point, albedo / kPi * light_->irradiance(point.x, point.z), glm::vec3(1.f), albedo, albedo};
}

UnlitGround GroundShading::shadowed_backdrop(const glm::vec3& point, const glm::vec3& seen) const {
    // What the backdrop shows below the horizon was lit by the backdrop's upper half. A camera at the height from which
    // it was photographed sees every point of the ground in the direction in which the photograph has it, so only the
    // light on it must change: times (light with the scene) / (light without it). Far from the scene that tends to 1
    // and is made 1, because there the photograph shows things that stand, not ground.
    const float near = std::clamp((12 - look_.away(point)) / 8, 0.f, 1.f);
    UnlitGround ground{point, seen, glm::vec3(0.f), glm::vec3(0.f), glm::vec3(0.f)};
    if (near <= 0)
        return ground;
    const float change = near * near * (3 - 2 * near);
    const glm::vec3 irradiance = light_->irradiance(point.x, point.z);
    for (std::size_t c = 0; c < 3; ++c)
        if (backdrop_irradiance_[c] > 0) {
            ground.total[c] *= 1 + change * (irradiance[c] / backdrop_irradiance_[c] - 1);
            ground.by_light[c] = seen[c] * change * kPi / backdrop_irradiance_[c];
        }
    ground.reflectance = glm::vec3(1.f);
    return ground;
}

} // namespace kokage

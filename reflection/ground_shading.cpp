#include "reflection/ground_shading.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

const glm::vec3 kUp(0, 1, 0);

} // namespace

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

GroundRadiance GroundShading::radiance(const glm::vec3& origin, const glm::vec3& direction, float distance,
                                       SampleIndex sample, ShadingScratch& scratch) const {
    if (direction.y >= 0)
        return {};
    const glm::vec3 point = look_.point(origin, direction, distance);
    return look_.mean_albedo() ? diffuse_plane(point, direction, distance, sample, scratch)
                               : shadowed_backdrop(point, backdrop_.seen(direction), sample, scratch);
}

glm::vec3 GroundShading::met_radiance(const glm::vec3& origin, const glm::vec3& direction, float distance,
                                      SampleIndex sample, ShadingScratch& scratch) const {
    if (direction.y >= 0)
        return glm::vec3(0.f);
    const glm::vec3 point = look_.point(origin, direction, distance);
    return look_.mean_albedo() ? light_at(point, *look_.mean_albedo(), sample, scratch).total
                               : shadowed_backdrop(point, backdrop_.remainder(direction), sample, scratch).total;
}

GroundRadiance GroundShading::light_at(const glm::vec3& point, const glm::vec3& albedo, SampleIndex sample,
                                       ShadingScratch& scratch) const {
    const Scattering scattering{kUp, albedo, glm::vec3(0.f)};
    const glm::vec3 direct = light_from_lights(lights_, queries_, point, scattering, sample, scratch).scattered;
    return {albedo / kPi * light_->irradiance(point.x, point.z) + direct, direct, albedo};
}

GroundRadiance GroundShading::diffuse_plane(const glm::vec3& point, const glm::vec3& direction, float distance,
                                            SampleIndex sample, ShadingScratch& scratch) const {
    // The plane of an exact model ends in a hard line at the horizon; air softens it towards the sky just above.
    const float clear = look_.clear(distance);
    GroundRadiance radiance;
    if (clear > 1e-4f)
        radiance = light_at(point, look_.albedo(point, direction, distance), sample, scratch);
    radiance.total = clear * radiance.total + (1 - clear) * look_.haze(direction);
    radiance.direct *= clear;
    return radiance;
}

GroundRadiance GroundShading::shadowed_backdrop(const glm::vec3& point, const glm::vec3& seen, SampleIndex sample,
                                                ShadingScratch& scratch) const {
    // What the backdrop shows below the horizon was lit by the backdrop's upper half. A camera at the height from which
    // it was photographed sees every point of the ground in the direction in which the photograph has it, so only the
    // light on it must change: times (light with the scene) / (light without it). Far from the scene that tends to 1
    // and is made 1, because there the photograph shows things that stand, not ground.
    const float near = std::clamp((12 - look_.away(point)) / 8, 0.f, 1.f);
    if (near <= 0)
        return {seen, glm::vec3(0.f), glm::vec3(0.f)};
    const GroundRadiance light = light_at(point, glm::vec3(1.f), sample, scratch);
    glm::vec3 ratio(1.f), direct(0.f);
    for (std::size_t c = 0; c < 3; ++c)
        if (backdrop_irradiance_[c] > 0) {
            ratio[c] = kPi * light.total[c] / backdrop_irradiance_[c];
            direct[c] = kPi * light.direct[c] / backdrop_irradiance_[c];
        }
    const float change = near * near * (3 - 2 * near);
    return {seen * (1.f + change * (ratio - 1.f)), seen * (change * direct), glm::vec3(0.f)};
}

} // namespace kokage

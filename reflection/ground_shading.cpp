#include "reflection/ground_shading.h"

namespace kokage {

GroundShading::GroundShading(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                             const Backdrop& backdrop, const GroundLook& look, const LightChoice& lights,
                             Progress& progress)
    : queries_(queries), backdrop_(backdrop), look_(look), lights_(lights) {
    if (!look.height())
        return;
    light_.emplace(scene, queries, backdrop, *look.height(), progress);
    if (look.is_backdrop())
        backdrop_ground_.emplace(environment, backdrop, look);
}

UnlitGround GroundShading::unlit(const glm::vec3& origin, const glm::vec3& direction, float distance) const {
    if (direction.y >= 0)
        return {};
    const glm::vec3 point = look_.point(origin, direction, distance);
    if (!look_.mean_albedo())
        return changed_backdrop(point, backdrop_.remainder(direction), backdrop_.lights(direction));
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
                                      const glm::vec3& lights, SampleIndex sample, ShadingScratch& scratch) const {
    if (direction.y >= 0)
        return glm::vec3(0.f);
    const glm::vec3 point = look_.point(origin, direction, distance);
    const UnlitGround ground = look_.mean_albedo() ? diffuse_plane(point, *look_.mean_albedo())
                                                   : changed_backdrop(point, backdrop_.remainder(direction), lights);
    return ground.lit(light_from_lights(lights_, queries_, point, ground.scattering(), sample, scratch).scattered)
        .total;
}

UnlitGround GroundShading::diffuse_plane(const glm::vec3& point, const glm::vec3& albedo) const {
    return {point, albedo / kPi * light_->irradiance(point.x, point.z), glm::vec3(1.f), albedo, albedo};
}

UnlitGround GroundShading::changed_backdrop(const glm::vec3& point, const glm::vec3& shown,
                                            const glm::vec3& lights) const {
    const BackdropGround::Share share = backdrop_ground_->share(point, shown, lights);
    UnlitGround ground{point, share.unchanged, share.albedo, glm::vec3(0.f), glm::vec3(0.f)};
    if (share.albedo == glm::vec3(0.f))
        return ground;
    ground.total += share.albedo / kPi * light_->irradiance(point.x, point.z);
    ground.reflectance = glm::vec3(1.f);
    return ground;
}

} // namespace kokage

#include "reflection/path_integrator.h"
#include "common/directions/about_axis.h"
#include "common/directions/lobes.h"
#include "reflection/glossy_light.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// As the path tracer of common/trace, which measured them.
constexpr double kLowContrast = 2.5;
constexpr float kSurvival = 1.5f;

float sum(const glm::vec3& rgb) {
    return rgb.r + rgb.g + rgb.b;
}

float largest(const glm::vec3& rgb) {
    return std::max({rgb.r, rgb.g, rgb.b});
}

glm::vec3 lobe_of(const PathVertex& vertex, const glm::vec3& direction) {
    if (glm::dot(vertex.normal, direction) <= 0)
        return glm::vec3(0.f);
    const glm::dvec3 apart = glm::dvec3(vertex.mirrored) - glm::dvec3(direction);
    return vertex.gloss * float(ggx_lobe_value(vertex.roughness, glm::dot(apart, apart)));
}

} // namespace

PathIntegrator::PathIntegrator(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                               const BackdropGround* backdrop_ground)
    : queries_(queries), patches_(*scene.patches), environment_(environment), points_(scene),
      remainder_(environment.remainder), lights_(environment), backdrop_ground_(backdrop_ground),
      offset_(queries.ray_offset()) {
    if (remainder_.contrast() > kLowContrast)
        remainder_share_ = 0.5f * (1 - std::sqrt(float(kLowContrast / remainder_.contrast())));
}

PathVertex PathIntegrator::surface_vertex(const SurfacePoint& at, const glm::vec3& direction) {
    PathVertex vertex{at.point,
                      at.geometric_normal,
                      at.normal,
                      at.optics,
                      at.gloss,
                      at.roughness,
                      glm::normalize(glm::reflect(direction, at.normal)),
                      {}};
    if (at.relief)
        vertex.relief = *at.relief;
    return vertex;
}

PathVertex PathIntegrator::ground_vertex(const glm::vec3& point, const glm::vec3& albedo) {
    PathVertex vertex;
    vertex.point = point;
    vertex.optics = {albedo, glm::vec3(0.f)};
    return vertex;
}

/// Rays leave on the side of the shading normal to which they go, so that no facet of a rounded surface hides them.
glm::vec3 PathIntegrator::start(const PathVertex& vertex, const glm::vec3& direction) const {
    return vertex.point + (glm::dot(vertex.normal, direction) > 0 ? offset_ : -offset_) * vertex.geometric_normal;
}

LightFromLights PathIntegrator::light(const PathVertex& vertex, PathNumbers& numbers) const {
    if (lights_.empty())
        return {};
    const float choice = numbers.single();
    const glm::vec2 place = numbers.pair();
    const auto ray = lights_.sample(vertex.point, vertex.normal, vertex.optics.reflectance + vertex.gloss,
                                    vertex.optics.transmittance, choice, place);
    if (!ray)
        return {};
    const float cosine = glm::dot(vertex.normal, ray->direction);
    const glm::vec3 scattered =
        (cosine > 0 ? vertex.optics.reflectance * cosine : vertex.optics.transmittance * -cosine) / kPi;
    glm::vec3 reflected(0.f);
    if (largest(vertex.gloss) > 0 && !(ray->distant && is_wide_for(*ray->distant, vertex.roughness)))
        reflected = lobe_of(vertex, ray->direction);
    if (!(largest(scattered + reflected) > 0) || (vertex.relief && vertex.relief->hides(ray->direction)) ||
        queries_.occluded(start(vertex, ray->direction), ray->direction, 0, ray->distance))
        return {};
    return {scattered * ray->irradiance, reflected * ray->irradiance};
}

/// One-sample multiple importance sampling (Veach 1997, 9.2.4) between the cosine lobes and the remainder's bright
/// parts.
PathIntegrator::Step PathIntegrator::scatter_diffuse(const PathVertex& vertex, float choice, glm::vec2 place) const {
    const float reflected = sum(vertex.optics.reflectance), transmitted = sum(vertex.optics.transmittance);
    Step step;
    if (!(reflected + transmitted > 0))
        return step;
    const float share = reflected / (reflected + transmitted);
    if (choice < remainder_share_) {
        step.direction = remainder_.sample(place, choice / remainder_share_).direction;
    } else {
        const bool back = (choice - remainder_share_) / (1 - remainder_share_) >= share;
        step.direction = about_axis(cosine_direction(place), back ? -vertex.normal : vertex.normal);
    }
    const float cosine = glm::dot(vertex.normal, step.direction);
    const float lobe = (cosine > 0 ? share : 1 - share) * std::abs(cosine) / kPi;
    const float density = remainder_share_ * (remainder_share_ > 0 ? remainder_.density(step.direction) : 0.f) +
                          (1 - remainder_share_) * lobe;
    if (density > 0)
        step.weight = (cosine > 0 ? vertex.optics.reflectance : vertex.optics.transmittance) *
                      (std::abs(cosine) / (kPi * density));
    return step;
}

PathIntegrator::Step PathIntegrator::scatter(const PathVertex& vertex, PathNumbers& numbers) const {
    const float diffuse = sum(vertex.optics.reflectance) + sum(vertex.optics.transmittance), gloss = sum(vertex.gloss);
    const float choice = numbers.single();
    const glm::vec2 place = numbers.pair();
    if (!(diffuse + gloss > 0))
        return {};
    const float glossy_share = gloss / (diffuse + gloss);
    Step step;
    if (choice < glossy_share) {
        const LobeSample drawn = sample_gloss(vertex.mirrored, vertex.roughness, place);
        const bool above = glm::dot(vertex.normal, drawn.direction) > 0;
        step = {drawn.direction, above ? vertex.gloss * (drawn.weight / glossy_share) : glm::vec3(0.f), true};
    } else {
        step = scatter_diffuse(vertex, (choice - glossy_share) / (1 - glossy_share), place);
        step.weight /= 1 - glossy_share;
    }
    return step;
}

SurfaceRadiance PathIntegrator::radiance(PathVertex vertex, PathNumbers& numbers) const {
    const LightFromLights first = light(vertex, numbers);
    SurfaceRadiance seen{first.scattered, glm::vec3(0.f), first.reflected};
    glm::vec3 bounced(0.f), throughput(1.f);
    bool by_gloss = false; ///< the first bounce
    bool met_backdrop_ground = vertex.on_backdrop;
    for (int bounce = 0;; ++bounce) {
        if (bounce > 0) {
            const LightFromLights lights = light(vertex, numbers);
            bounced += throughput * (lights.scattered + lights.reflected);
        }
        const Step step = scatter(vertex, numbers);
        if (bounce == 0)
            by_gloss = step.glossy;
        throughput *= step.weight;
        const float survival = std::min(0.99f, kSurvival * largest(throughput));
        if (!(numbers.independent() < survival))
            break;
        throughput /= survival;
        if (CameraHit next; vertex.relief && vertex.relief->surfaces->meets(*vertex.relief, step.direction, next)) {
            vertex = surface_vertex(points_.at(vertex.relief->hit.position, next), step.direction);
            continue;
        }
        const glm::vec3 origin = start(vertex, step.direction);
        float ground_distance = INFINITY, hidden_from = INFINITY;
        if (backdrop_ground_) {
            ground_distance = backdrop_ground_->look().distance(origin, step.direction);
            hidden_from = backdrop_ground_->look().distance_to_surfaces(ground_distance, step.direction);
        }
        RayHit hit;
        if (!queries_.first_hit(origin, step.direction, 0, hidden_from, hit)) {
            if (ground_distance < INFINITY && step.direction.y >= 0) // its underside
                break;
            const glm::vec3 shown = remainder_.radiance(step.direction),
                            lights = step.glossy ? wide_lights_in(environment_, step.direction, vertex.roughness)
                                                 : glm::vec3(0.f);
            if (!(ground_distance < INFINITY) || met_backdrop_ground) {
                bounced += throughput * shown;
                bounced += throughput * lights;
                break;
            }
            const glm::vec3 point = backdrop_ground_->look().point(origin, step.direction, ground_distance);
            const BackdropGround::Share share = backdrop_ground_->share(point, shown, lights);
            bounced += throughput * share.unchanged;
            vertex = ground_vertex(point, share.albedo);
            met_backdrop_ground = true;
            continue;
        }
        if (hit.ground && step.direction.y >= 0) // its underside
            break;
        vertex = hit.ground ? ground_vertex(origin + hit.distance * step.direction, patches_.ground->albedo)
                            : surface_vertex(origin, step.direction, hit);
        if (hit.ground)
            vertex.point.y = patches_.ground->height_m;
    }
    (by_gloss ? seen.reflection : seen.indirect) += bounced;
    return seen;
}

} // namespace kokage

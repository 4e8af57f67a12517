#include "reflection/camera_ray_shading.h"

namespace kokage {

UnlitHit CameraRayShading::unlit(const glm::vec3& origin, const CameraHit& hit, SampleIndex sample,
                                 std::uint32_t receiver, LightRays& rays, ShadingScratch& scratch) const {
    UnlitHit unlit;
    unlit.sample = sample;
    const float ground_distance = ground.distance(origin, hit.direction);
    if (hit.shows_surface(ground.distance_to_surfaces(ground_distance, hit.direction))) {
        unlit.kind = UnlitHit::Kind::surface;
        unlit.distance = hit.hit.distance;
        unlit.at = surfaces.point(origin, hit);
        if (surfaces.has_pixel_shadows())
            rays.add(receiver, lights, unlit.at.point, SurfaceShading::scattering(unlit.at, hit.direction), sample,
                     scratch, unlit.at.relief);
    } else if (ground_distance < std::numeric_limits<float>::infinity()) {
        unlit.kind = UnlitHit::Kind::ground;
        unlit.distance = ground_distance;
        unlit.ground = ground_light.unlit(origin, hit.direction, ground_distance);
        rays.add(receiver, lights, unlit.ground.point, unlit.ground.scattering(), sample, scratch);
    }
    return unlit;
}

std::uint32_t CameraRayShading::part_met(const glm::vec3& origin, const CameraHit& hit) const {
    const float ground_distance = ground.distance(origin, hit.direction);
    if (hit.shows_surface(ground.distance_to_surfaces(ground_distance, hit.direction)))
        return seen_part::of_patch(queries.scene().triangle_patch[hit.hit.triangle],
                                   hit.is_relief || glm::dot(hit.direction, hit.hit.geometric_normal) < 0);
    return ground_distance < std::numeric_limits<float>::infinity() ? seen_part::kGround : seen_part::kSurroundings;
}

SeenByRay CameraRayShading::lit(const UnlitHit& unlit, const glm::vec3& direction, const LightFromLights& light,
                                ShadingScratch& scratch) const {
    if (unlit.kind == UnlitHit::Kind::surroundings)
        return SeenByRay::surroundings(backdrop.seen(direction));
    if (unlit.kind == UnlitHit::Kind::ground) {
        const GroundRadiance lit = unlit.ground.lit(light.scattered);
        return SeenByRay::ground_at(lit.albedo, unlit.distance,
                                    {.direct = lit.direct, .indirect = lit.total - lit.direct});
    }
    SurfaceRadiance seen = surfaces.indirect(unlit.at);
    seen.direct = light.scattered;
    seen.reflection = light.reflected;
    seen.reflection += gloss.radiance(unlit.at, direction, seen.total(), unlit.sample, scratch);
    return SeenByRay::surface_at(unlit.at, unlit.distance, queries.scene(), seen);
}

} // namespace kokage

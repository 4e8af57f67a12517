#include "reflection/surface_shading.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr float kMostTurn = 8; ///< times the light that the mesh gets

/// Lights that relief hides.
void leave_out_hidden(const ReliefPoint& relief, ShadingScratch& scratch) {
    scratch.directions.clear();
    for (const ShadowRay& ray : scratch.rays)
        scratch.directions.push_back(ray.direction);
    scratch.hidden.resize(scratch.rays.size());
    relief.hides(scratch.directions, scratch.hidden);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < scratch.rays.size(); ++k)
        if (!scratch.hidden[k])
            scratch.rays[kept++] = scratch.rays[k];
    scratch.rays.resize(kept);
}

} // namespace

void choose_light_rays(const LightChoice& lights, const glm::vec3& point, const Scattering& scattering,
                       SampleIndex sample, ShadingScratch& scratch, const ReliefPoint* relief) {
    lights.rays_at(point, scattering, sample, scratch.rays, scratch.weights);
    if (relief && !scratch.rays.empty())
        leave_out_hidden(*relief, scratch);
}

LightFromLights light_from_lights(const LightChoice& lights, const RayQueries& queries, const glm::vec3& point,
                                  const Scattering& scattering, SampleIndex sample, ShadingScratch& scratch,
                                  const ReliefPoint* relief) {
    choose_light_rays(lights, point, scattering, sample, scratch, relief);
    const float near = queries.ray_offset();
    LightFromLights sum;
    for (const ShadowRay& ray : scratch.rays)
        if (!queries.occluded(point, ray.direction, near, ray.distance)) {
            sum.scattered += ray.radiance;
            sum.reflected += ray.reflection;
        }
    return sum;
}

SurfaceShading::SurfaceShading(const ShadedScene& scene, const RayQueries& queries, const LightChoice& lights,
                               bool pixel_shadows)
    : scene_(scene), queries_(queries), lights_(lights), points_(scene), pixel_shadows_(pixel_shadows) {
    if (pixel_shadows)
        for (const auto& [values, side] : {std::pair(&scene.indirect_front, "front"), {&scene.indirect_back, "back"}})
            if (values->size() != scene.patches->patches.size())
                throw InputError("picture: the scene has " + std::to_string(values->size()) + " " + side +
                                 " indirect radiances where " + std::to_string(scene.patches->patches.size()) +
                                 " are needed; give one for each");
    place_light();
}

void SurfaceShading::place_light() {
    const PatchScene& patches = *scene_.patches;
    const std::size_t count = patches.patches.size();
    corners_ = smooth_corners(scene_);
    const std::size_t corners = corners_.count;
    light_.assign(2 * (count + corners), glm::vec3(0.f));
    const std::vector<glm::vec3>*fronts = pixel_shadows_ ? &scene_.indirect_front : &scene_.radiance_front,
          *backs = pixel_shadows_ ? &scene_.indirect_back : &scene_.radiance_back;
    for (const auto& [side, of_patches] : {std::pair(std::size_t(0), fronts), {std::size_t(1), backs}}) {
        std::copy(of_patches->begin(), of_patches->end(), light_.begin() + std::ptrdiff_t(side * (count + corners)));
        if (corners > 0)
            smooth_light(side, *of_patches);
    }
}

void SurfaceShading::smooth_light(std::size_t side, const std::vector<glm::vec3>& of_patches) {
    struct Corner {
        glm::dvec3 light{0.0};
        double area = 0;
    };
    const PatchScene& patches = *scene_.patches;
    const std::size_t of_side = light_.size() / 2, count = patches.patches.size();
    std::vector<Corner> corners(of_side - count);
    for (std::size_t t = 0; t < patches.triangles.size(); ++t) {
        if (!scene_.looks[scene_.triangle_look[t]].smooth_normals)
            continue;
        const glm::uvec3 triangle = patches.triangles[t];
        const glm::dvec3 a = patches.positions[triangle.x], b = patches.positions[triangle.y],
                         c = patches.positions[triangle.z];
        const double area = glm::length(glm::cross(b - a, c - a));
        for (const std::uint32_t k : corners_.of_triangle[t]) {
            Corner& corner = corners[k];
            corner.light += area * glm::dvec3(of_patches[patches.triangle_patch[t]]);
            corner.area += area;
        }
    }
    for (std::size_t k = 0; k < corners.size(); ++k)
        if (corners[k].area > 0)
            light_[side * of_side + count + k] = corners[k].light / corners[k].area;
}

LightPlaces SurfaceShading::places(const SurfacePoint& at) const {
    const auto count = std::uint32_t(scene_.patches->patches.size());
    const std::uint32_t first = at.front ? 0 : std::uint32_t(light_.size() / 2);
    if (!at.smooth)
        return {{first + at.patch, first + at.patch, first + at.patch}, {1, 0, 0}};
    const auto& [a, b, c] = corners_.of_triangle[at.triangle];
    return {{first + count + a, first + count + b, first + count + c}, at.weights};
}

glm::vec3 SurfaceShading::solved(const SurfacePoint& at) const {
    const LightPlaces from = places(at);
    if (!at.smooth)
        return light_[from.places[0]] * gradients_.at(from.places[0], at.point);
    return from.weights.x * light_[from.places[0]] + from.weights.y * light_[from.places[1]] +
           from.weights.z * light_[from.places[2]];
}

glm::vec3 SurfaceShading::solved_radiance(const SurfacePoint& at) const {
    return at.texture * (at.front ? scene_.radiance_front[at.patch] : scene_.radiance_back[at.patch]);
}

glm::vec3 SurfaceShading::met_radiance(const SurfacePoint& at, const glm::vec3& direction, const MetGloss& gloss,
                                       SampleIndex sample, ShadingScratch& scratch) const {
    if (!pixel_shadows_)
        return solved_radiance(at);
    glm::vec3 light = at.texture * (at.front ? scene_.indirect_front[at.patch] : scene_.indirect_back[at.patch]);
    if (gloss.by_solution && !scene_.gloss_front.empty())
        light += at.gloss_texture * (at.front ? scene_.gloss_front[at.patch] : scene_.gloss_back[at.patch]);
    const Scattering scattering{at.normal,
                                at.optics.reflectance,
                                at.optics.transmittance,
                                at.gloss,
                                glm::reflect(direction, at.normal),
                                gloss.roughness(at),
                                gloss.by_solution};
    const LightFromLights lights = light_from_lights(lights_, queries_, at.point, scattering, sample, scratch);
    return light + lights.scattered + lights.reflected;
}

/// The solution has the light of the mesh. A slope of relief faces other light: as it would under the open sky, as far
/// as the place gets that light. And it sees its surroundings only in part (openness); where relief hides them there
/// are walls as open as this point, so that their light is rho (open E + (1 - open) walls' light): a geometric series.
glm::vec3 SurfaceShading::indirect_on_relief(const SurfacePoint& at) const {
    const ReliefPoint& relief = *at.relief;
    const glm::vec3 mesh_light = solved(at),
                    reflectance = scene_.patches->optics[scene_.patches->patches[at.patch].optics].reflectance;
    const glm::vec3 open_light = relief.surfaces->open_irradiance(relief.mesh_normal),
                    turned_light = relief.surfaces->open_irradiance(at.normal);
    const float in_the_open = luminance(reflectance * open_light) / kPi;
    const float share = in_the_open > 0 ? std::min(1.f, luminance(mesh_light) / in_the_open) : 0.f;
    glm::vec3 turn(1.f), walls(0.f);
    for (std::size_t c = 0; c < 3; ++c) {
        if (open_light[c] > 0)
            turn[c] = 1 + share * (std::min(turned_light[c] / open_light[c], kMostTurn) - 1);
        walls[c] = relief.openness / std::max(1 - reflectance[c] * (1 - relief.openness), 1e-3f);
    }
    // Gathered light takes the place of the indirect light that was solved.
    walls *=
        pixel_shadows_
            ? glm::max(scene_.radiance_front[at.patch] - scene_.indirect_front[at.patch], glm::vec3(0.f)) + mesh_light
            : mesh_light;
    return relief.openness * at.texture * mesh_light * turn + (1 - relief.openness) * at.optics.reflectance * walls;
}

SurfaceRadiance SurfaceShading::indirect(const SurfacePoint& at) const {
    SurfaceRadiance result;
    result.indirect = at.relief ? indirect_on_relief(at) : at.texture * solved(at);
    return result;
}

Scattering SurfaceShading::scattering(const SurfacePoint& at, const glm::vec3& direction) {
    return {at.normal,   at.optics.reflectance, at.optics.transmittance, at.gloss, glm::reflect(direction, at.normal),
            at.roughness};
}

SurfaceRadiance SurfaceShading::radiance(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                                         ShadingScratch& scratch) const {
    SurfaceRadiance result = indirect(at);
    if (!pixel_shadows_)
        return result;
    const LightFromLights lights =
        light_from_lights(lights_, queries_, at.point, scattering(at, direction), sample, scratch, at.relief);
    result.direct = lights.scattered;
    result.reflection = lights.reflected;
    return result;
}

} // namespace kokage

#include "reflection/surface_shading.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>
#include <unordered_map>

namespace kokage {
namespace {

glm::vec3 interpolate(const std::vector<glm::vec3>& values, const glm::uvec3& corners, const glm::vec3& weights) {
    return weights.x * values[corners.x] + weights.y * values[corners.y] + weights.z * values[corners.z];
}

constexpr float kMostTurn = 8; ///< times the light that the mesh gets

struct PositionHash {
    std::size_t operator()(const glm::vec3& p) const {
        std::array<std::uint32_t, 3> bits;
        std::memcpy(bits.data(), &p, sizeof(bits));
        return hash64(hash64(hash64(bits[0]) + bits[1]) + bits[2]);
    }
};

} // namespace

namespace {

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

LightFromLights light_from_lights(const LightChoice& lights, const RayQueries& queries, const glm::vec3& point,
                                  const Scattering& scattering, SampleIndex sample, ShadingScratch& scratch,
                                  const ReliefPoint* relief) {
    lights.rays_at(point, scattering, sample, scratch.rays, scratch.weights);
    if (relief && !scratch.rays.empty())
        leave_out_hidden(*relief, scratch);
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
    smooth_solution();
}

void SurfaceShading::smooth_solution() {
    bool any = false;
    for (const SurfaceLook& look : scene_.looks)
        any |= look.smooth_normals;
    if (!any)
        return;
    struct Corner {
        glm::dvec3 front{0.0}, back{0.0};
        double area = 0;
    };
    const PatchScene& patches = *scene_.patches;
    const std::vector<glm::vec3>& front = pixel_shadows_ ? scene_.indirect_front : scene_.radiance_front;
    const std::vector<glm::vec3>& back = pixel_shadows_ ? scene_.indirect_back : scene_.radiance_back;
    // Corners are joined by place, because texture seams double them.
    std::unordered_map<glm::vec3, Corner, PositionHash> corners;
    for (std::size_t t = 0; t < patches.triangles.size(); ++t) {
        if (!scene_.looks[scene_.triangle_look[t]].smooth_normals)
            continue;
        const glm::uvec3 triangle = patches.triangles[t];
        const glm::dvec3 a = patches.positions[triangle.x], b = patches.positions[triangle.y],
                         c = patches.positions[triangle.z];
        const double area = glm::length(glm::cross(b - a, c - a));
        const std::uint32_t patch = patches.triangle_patch[t];
        for (int k = 0; k < 3; ++k) {
            Corner& corner = corners[patches.positions[triangle[std::size_t(k)]]];
            corner.front += area * glm::dvec3(front[patch]);
            corner.back += area * glm::dvec3(back[patch]);
            corner.area += area;
        }
    }
    smooth_front_.assign(patches.positions.size(), glm::vec3(0.f));
    smooth_back_.assign(patches.positions.size(), glm::vec3(0.f));
    for (std::size_t i = 0; i < patches.positions.size(); ++i)
        if (const auto found = corners.find(patches.positions[i]); found != corners.end() && found->second.area > 0) {
            smooth_front_[i] = found->second.front / found->second.area;
            smooth_back_[i] = found->second.back / found->second.area;
        }
}

glm::vec3 SurfaceShading::solved(const SurfacePoint& at) const {
    if (at.smooth)
        return interpolate(at.front ? smooth_front_ : smooth_back_, scene_.patches->triangles[at.triangle], at.weights);
    if (pixel_shadows_)
        return at.front ? scene_.indirect_front[at.patch] : scene_.indirect_back[at.patch];
    return at.front ? scene_.radiance_front[at.patch] : scene_.radiance_back[at.patch];
}

glm::vec3 SurfaceShading::solved_radiance(const SurfacePoint& at) const {
    return at.texture * (at.front ? scene_.radiance_front[at.patch] : scene_.radiance_back[at.patch]);
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
    walls *= scene_.radiance_front[at.patch];
    return relief.openness * at.texture * mesh_light * turn + (1 - relief.openness) * at.optics.reflectance * walls;
}

SurfaceRadiance SurfaceShading::radiance(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                                         ShadingScratch& scratch) const {
    SurfaceRadiance result;
    result.indirect = at.relief ? indirect_on_relief(at) : at.texture * solved(at);
    if (!pixel_shadows_)
        return result;
    const Scattering scattering{
        at.normal,   at.optics.reflectance, at.optics.transmittance, at.gloss, glm::reflect(direction, at.normal),
        at.roughness};
    const LightFromLights lights =
        light_from_lights(lights_, queries_, at.point, scattering, sample, scratch, at.relief);
    result.direct = lights.scattered;
    result.reflection = lights.reflected;
    return result;
}

} // namespace kokage

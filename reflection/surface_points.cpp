#include "reflection/surface_points.h"
#include "common/services/error.h"
#include "reflection/texture_lookup.h"

#include <algorithm>
#include <string>

namespace kokage {
namespace {

void check_size(std::size_t size, std::size_t expected, const char* what) {
    if (size != expected)
        throw InputError(std::string("picture: the scene has ") + std::to_string(size) + " " + what + " where " +
                         std::to_string(expected) + " are needed; give one for each");
}

void check_look(const SurfaceLook& look) {
    const Image* color = look.base_color_texture.get();
    if (color && (color->channels < 3 || color->empty()))
        throw InputError("picture: a base colour texture has " + std::to_string(color->channels) +
                         " channels; it needs at least 3");
    if (look.gloss.roughness_texture && look.gloss.roughness_texture->empty())
        throw InputError("picture: a roughness texture has no texels");
}

/// The surface that smooth normals describe, at a point of a flat triangle (Hanika, "Hacking the Shadow Terminator",
/// Ray Tracing Gems II, chapter 4): shadow rays start on it, so that facets don't shadow themselves.
glm::vec3 lifted(const glm::vec3& point, const ShadedScene& scene, const glm::uvec3& corners, const glm::vec3& weights,
                 float side) {
    glm::vec3 lift(0.f);
    for (std::size_t k = 0; k < 3; ++k) {
        const glm::vec3 normal = side * scene.normals[corners[k]];
        const float below = std::min(0.f, glm::dot(point - scene.patches->positions[corners[k]], normal));
        lift -= weights[k] * below * normal;
    }
    return point + lift;
}

glm::vec2 coordinate(const PatchScene& patches, const glm::uvec3& corners, const glm::vec3& weights) {
    return weights.x * patches.uvs[corners.x] + weights.y * patches.uvs[corners.y] + weights.z * patches.uvs[corners.z];
}

glm::vec3 texture_factor(const SurfaceLook& look, const glm::vec2& uv) {
    const glm::vec3 color = look.base_color * texture_color(*look.base_color_texture, uv, look.wrap_u, look.wrap_v);
    glm::vec3 factor(1.f);
    for (std::size_t c = 0; c < 3; ++c)
        if (look.mean_base_color[c] > 0)
            factor[c] = color[c] / look.mean_base_color[c];
    return factor;
}

} // namespace

SurfacePoints::SurfacePoints(const ShadedScene& scene) : scene_(scene) {
    const PatchScene& patches = *scene.patches;
    if (!scene.looks.empty()) {
        check_size(scene.triangle_look.size(), patches.triangles.size(), "triangle looks");
        for (std::uint32_t look : scene.triangle_look)
            if (look >= scene.looks.size())
                throw InputError("picture: a triangle names look " + std::to_string(look) + " of " +
                                 std::to_string(scene.looks.size()));
        for (const SurfaceLook& look : scene.looks)
            check_look(look);
    }
    if (!scene.normals.empty())
        check_size(scene.normals.size(), patches.positions.size(), "normals");
    check_size(scene.radiance_front.size(), patches.patches.size(), "front radiances");
    check_size(scene.radiance_back.size(), patches.patches.size(), "back radiances");
}

const SurfaceLook* SurfacePoints::look_of(std::uint32_t triangle) const {
    return scene_.looks.empty() ? nullptr : &scene_.looks[scene_.triangle_look[triangle]];
}

SurfacePoint SurfacePoints::on_mesh(const glm::vec3& point, const RayHit& hit, bool front) const {
    const PatchScene& patches = *scene_.patches;
    const glm::uvec3 corners = patches.triangles[hit.triangle];
    const SurfaceLook* look = look_of(hit.triangle);
    SurfacePoint at;
    at.triangle = hit.triangle;
    at.patch = patches.triangle_patch[hit.triangle];
    at.weights = {1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric};
    at.front = front;
    at.smooth = look && look->smooth_normals;
    const float side = at.front ? 1.f : -1.f;
    at.normal = at.geometric_normal = side * hit.geometric_normal;
    at.point = point;
    if (at.smooth && !scene_.normals.empty()) {
        const glm::vec3 interpolated = at.weights.x * scene_.normals[corners.x] +
                                       at.weights.y * scene_.normals[corners.y] +
                                       at.weights.z * scene_.normals[corners.z];
        if (const float length = glm::length(interpolated); length > 1e-6f)
            at.normal = side * interpolated / length;
        at.point = lifted(at.point, scene_, corners, at.weights, side);
    }
    return at;
}

SurfacePoint SurfacePoints::at(const glm::vec3& origin, const glm::vec3& direction, const RayHit& hit) const {
    SurfacePoint at = on_mesh(origin + hit.distance * direction, hit, glm::dot(direction, hit.geometric_normal) < 0);
    dress(at, direction);
    return at;
}

SurfacePoint SurfacePoints::at(const glm::vec3& origin, const CameraHit& hit) const {
    if (!hit.is_relief)
        return at(origin, hit.direction, hit.hit);
    const PatchScene& patches = *scene_.patches;
    const glm::uvec3 corners = patches.triangles[hit.hit.triangle];
    const glm::vec3 weights = hit.relief.hit.weights;
    SurfacePoint at = on_mesh(weights.x * patches.positions[corners.x] + weights.y * patches.positions[corners.y] +
                                  weights.z * patches.positions[corners.z],
                              hit.hit, true);
    at.normal = hit.relief.hit.shading_normal;
    at.relief = &hit.relief;
    dress(at, hit.direction);
    return at;
}

/// Colour and gloss.
void SurfacePoints::dress(SurfacePoint& at, const glm::vec3& direction) const {
    const PatchScene& patches = *scene_.patches;
    const glm::uvec3 corners = patches.triangles[at.triangle];
    const SurfaceLook* look = look_of(at.triangle);
    at.optics = patches.optics[patches.patches[at.patch].optics];
    if (!look)
        return;
    const bool has_uvs = !patches.uvs.empty();
    const glm::vec2 uv = has_uvs ? coordinate(patches, corners, at.weights) : glm::vec2(0.f);
    if (look->base_color_texture && has_uvs) {
        at.texture = texture_factor(*look, uv);
        at.optics.reflectance *= at.texture;
        at.optics.transmittance *= at.texture;
    }
    if (!look->gloss.is_matt()) {
        at.roughness =
            look->gloss.roughness_gradient ? look->gloss.roughness_gradient->at(at.point.y) : look->gloss.roughness;
        if (look->gloss.roughness_texture && has_uvs)
            at.roughness *= texture_value(*look->gloss.roughness_texture, uv, look->wrap_u, look->wrap_v);
        at.roughness = std::clamp(at.roughness, kLeastRoughness, 1.f);
        const glm::vec3 reflectance =
            glm::min(look->gloss.normal_reflectance + (at.texture - 1.f) * look->gloss.tinted_reflectance, 1.f);
        for (std::size_t c = 0; c < 3; ++c)
            if (look->gloss.normal_reflectance[c] > 0)
                at.gloss_texture[c] = reflectance[c] / look->gloss.normal_reflectance[c];
        at.gloss = gloss_reflectance(reflectance, at.roughness, -glm::dot(at.normal, direction));
    }
}

} // namespace kokage

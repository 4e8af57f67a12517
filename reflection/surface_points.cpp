#include "reflection/surface_points.h"
#include "common/services/error.h"
#include "reflection/texture_lookup.h"

#include <algorithm>
#include <cmath>
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
    if (look.normal_texture && (look.normal_texture->channels < 3 || look.normal_texture->empty()))
        throw InputError("picture: a texture of normals has " + std::to_string(look.normal_texture->channels) +
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

/// The normal of a triangle's front as its look's texture turns it; `normal` where the triangle has no size in texture.
glm::vec3 turned_normal(const PatchScene& patches, const glm::uvec3& corners, const SurfaceLook& look,
                        const glm::vec2& uv, const glm::vec3& normal) {
    const glm::vec3 p = patches.positions[corners.y] - patches.positions[corners.x],
                    q = patches.positions[corners.z] - patches.positions[corners.x];
    const glm::vec2 a = patches.uvs[corners.y] - patches.uvs[corners.x],
                    b = patches.uvs[corners.z] - patches.uvs[corners.x];
    const float handed = a.x * b.y - a.y * b.x < 0 ? -1.f : 1.f;
    glm::vec3 along_u = handed * (b.y * p - a.y * q), along_v = handed * (a.x * q - b.x * p);
    along_u -= glm::dot(along_u, normal) * normal;
    along_v -= glm::dot(along_v, normal) * normal;
    const float u_length = glm::length(along_u), v_length = glm::length(along_v);
    const glm::vec3 local = 2.f * texture_color(*look.normal_texture, uv, look.wrap_u, look.wrap_v) - 1.f;
    if (!(u_length > 0 && v_length > 0 && local.z > 0) || !std::isfinite(u_length + v_length))
        return normal;
    const glm::vec3 turned =
        look.normal_scale * (local.x / u_length * along_u - local.y / v_length * along_v) + local.z * normal;
    const float length = glm::length(turned);
    return length > 1e-6f && std::isfinite(length) ? turned / length : normal;
}

/// Turned towards the viewer where it faces away, as far as that it is seen at a grazing angle.
glm::vec3 seen_normal(const glm::vec3& normal, const glm::vec3& direction) {
    constexpr float kGrazing = 0.02f;
    const float cosine = -glm::dot(normal, direction);
    return cosine >= kGrazing ? normal : glm::normalize(normal - (kGrazing - cosine) * direction);
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
    if (look->normal_texture && has_uvs && !at.relief) {
        const float side = at.front ? 1.f : -1.f;
        at.normal = seen_normal(side * turned_normal(patches, corners, *look, uv, side * at.normal), direction);
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

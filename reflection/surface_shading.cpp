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

void check_size(std::size_t size, std::size_t expected, const char* what) {
    if (size != expected)
        throw InputError(std::string("picture: the scene has ") + std::to_string(size) + " " + what + " where " +
                         std::to_string(expected) + " are needed; give one for each");
}

glm::vec3 interpolate(const std::vector<glm::vec3>& values, const glm::uvec3& corners, const glm::vec3& weights) {
    return weights.x * values[corners.x] + weights.y * values[corners.y] + weights.z * values[corners.z];
}

int wrap(int texel, int size, TextureWrap mode) {
    if (mode == TextureWrap::clamp)
        return std::clamp(texel, 0, size - 1);
    if (mode == TextureWrap::repeat)
        return (texel % size + size) % size;
    const int period = (texel % (2 * size) + 2 * size) % (2 * size);
    return period < size ? period : 2 * size - 1 - period;
}

/// Bilinear lookup. Coordinates are first reduced to two tiles, so that any finite value is exact enough.
glm::vec3 texture_color(const Image& image, glm::vec2 uv, TextureWrap wrap_u, TextureWrap wrap_v) {
    uv.x = wrap_u == TextureWrap::clamp ? std::clamp(uv.x, 0.f, 1.f) : uv.x - 2.f * std::floor(uv.x * 0.5f);
    uv.y = wrap_v == TextureWrap::clamp ? std::clamp(uv.y, 0.f, 1.f) : uv.y - 2.f * std::floor(uv.y * 0.5f);
    const float x = uv.x * float(image.width) - 0.5f, y = uv.y * float(image.height) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    const float fx = x - float(x0), fy = y - float(y0);
    glm::vec3 sum(0.f);
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float* texel = image.at(wrap(x0 + i, image.width, wrap_u), wrap(y0 + j, image.height, wrap_v));
            sum += (i ? fx : 1 - fx) * (j ? fy : 1 - fy) * glm::vec3(texel[0], texel[1], texel[2]);
        }
    return sum;
}

struct PositionHash {
    std::size_t operator()(const glm::vec3& p) const {
        std::array<std::uint32_t, 3> bits;
        std::memcpy(bits.data(), &p, sizeof(bits));
        return hash64(hash64(hash64(bits[0]) + bits[1]) + bits[2]);
    }
};

} // namespace

glm::vec3 light_from_lights(const LightChoice& lights, const RayQueries& queries, const glm::vec3& point,
                            const Scattering& scattering, SampleIndex sample, ShadingScratch& scratch) {
    lights.rays_at(point, scattering, sample, scratch.rays, scratch.weights);
    const float near = queries.ray_offset();
    glm::vec3 sum(0.f);
    for (const ShadowRay& ray : scratch.rays)
        if (!queries.occluded(point, ray.direction, near, ray.distance))
            sum += ray.radiance;
    return sum;
}

SurfaceShading::SurfaceShading(const ShadedScene& scene, const RayQueries& queries, const LightChoice& lights,
                               bool pixel_shadows)
    : scene_(scene), queries_(queries), lights_(lights), pixel_shadows_(pixel_shadows) {
    const PatchScene& patches = *scene.patches;
    if (!scene.looks.empty()) {
        check_size(scene.triangle_look.size(), patches.triangles.size(), "triangle looks");
        for (std::uint32_t look : scene.triangle_look)
            if (look >= scene.looks.size())
                throw InputError("picture: a triangle names look " + std::to_string(look) + " of " +
                                 std::to_string(scene.looks.size()));
        for (const SurfaceLook& look : scene.looks)
            if (look.base_color_texture && (look.base_color_texture->channels < 3 || look.base_color_texture->empty()))
                throw InputError("picture: a base colour texture has " +
                                 std::to_string(look.base_color_texture->channels) + " channels; it needs at least 3");
    }
    if (!scene.normals.empty())
        check_size(scene.normals.size(), patches.positions.size(), "normals");
    check_size(scene.radiance_front.size(), patches.patches.size(), "front radiances");
    check_size(scene.radiance_back.size(), patches.patches.size(), "back radiances");
    if (pixel_shadows) {
        check_size(scene.indirect_front.size(), patches.patches.size(), "front indirect radiances");
        check_size(scene.indirect_back.size(), patches.patches.size(), "back indirect radiances");
    }
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

glm::vec3 SurfaceShading::texture_factor(std::uint32_t triangle, const glm::vec3& weights) const {
    if (scene_.looks.empty())
        return glm::vec3(1.f);
    const SurfaceLook& look = scene_.looks[scene_.triangle_look[triangle]];
    const PatchScene& patches = *scene_.patches;
    if (!look.base_color_texture || patches.uvs.empty())
        return glm::vec3(1.f);
    const glm::uvec3 corners = patches.triangles[triangle];
    const glm::vec2 uv =
        weights.x * patches.uvs[corners.x] + weights.y * patches.uvs[corners.y] + weights.z * patches.uvs[corners.z];
    const glm::vec3 color = look.base_color * texture_color(*look.base_color_texture, uv, look.wrap_u, look.wrap_v);
    glm::vec3 factor(1.f);
    for (std::size_t c = 0; c < 3; ++c)
        if (look.mean_base_color[c] > 0)
            factor[c] = color[c] / look.mean_base_color[c];
    return factor;
}

glm::vec3 SurfaceShading::radiance(const glm::vec3& origin, const glm::vec3& direction, const RayHit& hit,
                                   SampleIndex sample, ShadingScratch& scratch) const {
    const PatchScene& patches = *scene_.patches;
    const std::uint32_t patch = patches.triangle_patch[hit.triangle];
    const glm::uvec3 corners = patches.triangles[hit.triangle];
    const glm::vec3 weights(1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric);
    const bool front = glm::dot(direction, hit.geometric_normal) < 0;
    const bool smooth = !scene_.looks.empty() && scene_.looks[scene_.triangle_look[hit.triangle]].smooth_normals;
    const glm::vec3 factor = texture_factor(hit.triangle, weights);

    glm::vec3 solved;
    if (smooth)
        solved = interpolate(front ? smooth_front_ : smooth_back_, corners, weights);
    else if (pixel_shadows_)
        solved = front ? scene_.indirect_front[patch] : scene_.indirect_back[patch];
    else
        solved = front ? scene_.radiance_front[patch] : scene_.radiance_back[patch];
    if (!pixel_shadows_)
        return factor * solved;

    const float side = front ? 1.f : -1.f;
    glm::vec3 normal = side * hit.geometric_normal, point = origin + hit.distance * direction;
    if (smooth && !scene_.normals.empty()) {
        const glm::vec3 interpolated = interpolate(scene_.normals, corners, weights);
        if (const float length = glm::length(interpolated); length > 1e-6f)
            normal = side * interpolated / length;
        // Shadow rays start on the rounded surface that the normals describe (Hanika, "Hacking the Shadow Terminator",
        // Ray Tracing Gems II, chapter 4), so that facets don't shadow themselves.
        glm::vec3 lift(0.f);
        for (std::size_t k = 0; k < 3; ++k) {
            const glm::vec3 corner_normal = side * scene_.normals[corners[k]];
            const float below = std::min(0.f, glm::dot(point - patches.positions[corners[k]], corner_normal));
            lift -= weights[k] * below * corner_normal;
        }
        point += lift;
    }
    const Optics& optics = patches.optics[patches.patches[patch].optics];
    const Scattering scattering{normal, optics.reflectance, optics.transmittance};
    return factor * (solved + light_from_lights(lights_, queries_, point, scattering, sample, scratch));
}

} // namespace kokage

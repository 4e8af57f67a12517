#include "common/scene/mesh_scene.h"

#include <cmath>

namespace kokage {

bool lies_alike(const SceneTexture& a, const SceneTexture& b) {
    return a.texture_coordinates == b.texture_coordinates && a.offset == b.offset && a.scale == b.scale &&
           a.rotation == b.rotation && a.wrap_u == b.wrap_u && a.wrap_v == b.wrap_v;
}

std::vector<glm::vec3> compute_normals(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 a(positions[t.x]), b(positions[t.y]), c(positions[t.z]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        for (const std::uint32_t corner : {t.x, t.y, t.z})
            sums[corner] += normal;
    }
    std::vector<glm::vec3> normals(positions.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
        const double length = glm::length(sums[i]);
        normals[i] = length > 0 && std::isfinite(length) ? glm::vec3(sums[i] / length) : glm::vec3(0, 1, 0);
    }
    return normals;
}

SceneTexture split_alpha(const Image& image) {
    const std::size_t count = std::size_t(image.width) * std::size_t(image.height);
    const std::size_t channels = std::size_t(image.channels);
    auto color = std::make_shared<Image>(image.width, image.height, 3);
    const bool grey = channels <= 2, has_alpha = channels == 2 || channels == 4;
    std::shared_ptr<Image> alpha = has_alpha ? std::make_shared<Image>(image.width, image.height, 1) : nullptr;
    bool opaque = true;
    for (std::size_t i = 0; i < count; ++i) {
        const float* from = image.pixels.data() + i * channels;
        for (std::size_t c = 0; c < 3; ++c)
            color->pixels[i * 3 + c] = from[grey ? 0 : c];
        if (alpha) {
            alpha->pixels[i] = from[channels - 1];
            opaque = opaque && from[channels - 1] >= 1.f;
        }
    }
    SceneTexture texture;
    texture.color = std::move(color);
    if (!opaque)
        texture.alpha = std::move(alpha);
    return texture;
}

glm::dvec3 choose_origin(const glm::dvec3& low, const glm::dvec3& high) {
    if (!(low.x <= high.x))
        return glm::dvec3(0.0);
    const glm::dvec3 centre = 0.5 * (low + high);
    return glm::length(centre) > 16 * glm::length(high - low) ? centre : glm::dvec3(0.0);
}

void set_upright(MeshScene& scene) {
    const auto turned = [](const auto& v) { return std::decay_t<decltype(v)>(v.x, v.z, -v.y); };
    scene.origin = turned(scene.origin);
    for (SceneMesh& mesh : scene.meshes) {
        for (glm::vec3& position : mesh.positions)
            position = turned(position);
        for (glm::vec3& normal : mesh.normals)
            normal = turned(normal);
    }
}

} // namespace kokage

#include "foliage/patch_sampling.h"
#include "foliage/patch_geometry.h"

#include <algorithm>
#include <cmath>

namespace kokage {

namespace {

constexpr int kTries = 32;

std::uint32_t pick_triangle(const PatchScene& scene, const Patch& patch, double u) {
    if (patch.triangle_count == 1)
        return patch.first_triangle;
    double total = 0;
    for (std::uint32_t i = 0; i < patch.triangle_count; ++i)
        total += glm::length(twice_area_vector(scene, patch.first_triangle + i));
    double left = u * total;
    for (std::uint32_t i = 0; i + 1 < patch.triangle_count; ++i) {
        left -= glm::length(twice_area_vector(scene, patch.first_triangle + i));
        if (left < 0)
            return patch.first_triangle + i;
    }
    return patch.first_triangle + patch.triangle_count - 1;
}

} // namespace

PatchPoint sample_patch(const PatchScene& scene, std::uint32_t index, Random& random) {
    PatchPoint point;
    const Patch& patch = scene.patches[index];
    if (patch.triangle_count == 0)
        return point;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        const std::uint32_t triangle = pick_triangle(scene, patch, random.uniform_double());
        const float root = std::sqrt(random.uniform()), u1 = random.uniform();
        const float b1 = root * (1 - u1), b2 = root * u1, b0 = 1 - root; // uniform over the triangle
        const glm::uvec3 corner = scene.triangles[triangle];
        point.position =
            b0 * scene.positions[corner.x] + b1 * scene.positions[corner.y] + b2 * scene.positions[corner.z];
        const glm::dvec3 normal = twice_area_vector(scene, triangle);
        if (const double length = glm::length(normal); length > 0)
            point.normal = glm::vec3(normal / length);
        if (!scene.masked(triangle))
            break;
        const glm::vec2 uv = b0 * scene.uvs[corner.x] + b1 * scene.uvs[corner.y] + b2 * scene.uvs[corner.z];
        if (scene.masks[std::size_t(scene.triangle_mask[triangle])].solid(uv))
            break;
    }
    return point;
}

glm::vec3 cosine_direction(const glm::vec3& normal, float u0, float u1) {
    const glm::vec3 helper = std::abs(normal.x) > 0.5f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    const glm::vec3 tangent = glm::normalize(glm::cross(helper, normal)), bitangent = glm::cross(normal, tangent);
    const float radius = std::sqrt(u0), azimuth = 2 * kPi * u1, height = std::sqrt(std::max(0.f, 1 - u0));
    return glm::normalize(radius * std::cos(azimuth) * tangent + radius * std::sin(azimuth) * bitangent +
                          height * normal);
}

} // namespace kokage

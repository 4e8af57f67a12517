#include "foliage/patch_points.h"

#include <algorithm>

namespace kokage {
namespace {

/// So many points in holes in a row mean less than one solid point in 1e5: the patch counts as empty.
constexpr int kTries = 100000;

glm::dvec3 twice_area(const PatchScene& scene, std::size_t triangle) {
    const glm::uvec3& corners = scene.triangles[triangle];
    const glm::dvec3 a(scene.positions[corners.x]);
    return glm::cross(glm::dvec3(scene.positions[corners.y]) - a, glm::dvec3(scene.positions[corners.z]) - a);
}

/// Weights of corners 1 and 2 of a uniform point, by the map of Heitz 2019, "A low-distortion map between triangle and
/// square".
glm::vec2 uniform_in_triangle(glm::vec2 numbers) {
    if (numbers.y > numbers.x) {
        numbers.x *= 0.5f;
        numbers.y -= numbers.x;
    } else {
        numbers.y *= 0.5f;
        numbers.x -= numbers.y;
    }
    return numbers;
}

} // namespace

PatchPoints::PatchPoints(const PatchScene& scene)
    : scene_(scene), cumulative_(scene.triangles.size(), 0.f), areas_(solid_areas(scene)) {
    for (const Patch& patch : scene.patches) {
        double total = 0;
        for (std::uint32_t t = 0; t < patch.triangle_count; ++t)
            total += glm::length(twice_area(scene, patch.first_triangle + t));
        double sum = 0;
        for (std::uint32_t t = 0; t < patch.triangle_count && total > 0; ++t) {
            sum += glm::length(twice_area(scene, patch.first_triangle + t));
            cumulative_[patch.first_triangle + t] = float(sum / total);
        }
    }
}

bool PatchPoints::sample(std::uint32_t index, PathNumbers& numbers, PatchPoint& point) const {
    const Patch& patch = scene_.patches[index];
    glm::vec2 place = numbers.pair();
    if (!(areas_[index] > 0))
        return false;
    const float* begin = cumulative_.data() + patch.first_triangle;
    for (int tries = 0; tries < kTries; ++tries) {
        const float* found = std::upper_bound(begin, begin + patch.triangle_count - 1, place.x);
        const float low = found > begin ? found[-1] : 0.f, share = *found - low;
        if (share > 0) {
            const std::size_t triangle = patch.first_triangle + std::size_t(found - begin);
            const glm::uvec3& corners = scene_.triangles[triangle];
            const glm::vec2 weights = uniform_in_triangle({std::min((place.x - low) / share, 1.f), place.y});
            const auto mix = [&](const auto& of) {
                return of[corners.x] + weights.x * (of[corners.y] - of[corners.x]) +
                       weights.y * (of[corners.z] - of[corners.x]);
            };
            if (!scene_.masked(triangle) ||
                scene_.masks[std::size_t(scene_.triangle_mask[triangle])].solid(mix(scene_.uvs))) {
                point.position = mix(scene_.positions);
                point.normal = glm::vec3(glm::normalize(twice_area(scene_, triangle)));
                return true;
            }
        }
        const float x = numbers.independent();
        place = {x, numbers.independent()};
    }
    return false;
}

} // namespace kokage

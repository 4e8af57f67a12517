#include "reflection/flat_patches.h"
#include "common/services/parallel.h"

namespace kokage {
namespace {

/// Of 20 degrees. With 3, an oak's leaves close by were 3.5 % from the truth in place of 3.1 %, for 1.4 times the time.
constexpr double kLeastCosine = 0.94;
constexpr double kMostAside = 0.01; ///< of the area: slivers face anywhere

/// Twice the area long.
glm::dvec3 area_normal(const PatchScene& scene, std::uint32_t triangle) {
    const glm::uvec3 corners = scene.triangles[triangle];
    const glm::dvec3 a = scene.positions[corners.x];
    return glm::cross(glm::dvec3(scene.positions[corners.y]) - a, glm::dvec3(scene.positions[corners.z]) - a);
}

bool is_flat(const PatchScene& scene, const Patch& patch) {
    if (patch.triangle_count < 2)
        return true;
    const std::uint32_t end = patch.first_triangle + patch.triangle_count;
    glm::dvec3 sum(0.);
    for (std::uint32_t t = patch.first_triangle; t < end; ++t)
        sum += area_normal(scene, t);
    const double length = glm::length(sum);
    double all = 0, aside = 0;
    for (std::uint32_t t = patch.first_triangle; t < end; ++t) {
        const glm::dvec3 normal = area_normal(scene, t);
        const double area = glm::length(normal);
        all += area;
        aside += glm::dot(normal, sum) > kLeastCosine * area * length ? 0 : area;
    }
    return aside <= kMostAside * all;
}

} // namespace

std::vector<std::uint8_t> flat_patches(const PatchScene& scene) {
    std::vector<std::uint8_t> flat(scene.patches.size());
    parallel_blocks(flat.size(), 4096, [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
            flat[p] = is_flat(scene, scene.patches[p]);
    });
    return flat;
}

} // namespace kokage

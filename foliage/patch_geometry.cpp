#include "foliage/patch_geometry.h"

#include <cmath>

namespace kokage {

glm::dvec3 twice_area_vector(const PatchScene& scene, std::uint32_t triangle) {
    const glm::uvec3 corner = scene.triangles[triangle];
    const glm::dvec3 a = scene.positions[corner.x], b = scene.positions[corner.y], c = scene.positions[corner.z];
    return glm::cross(b - a, c - a);
}

PatchGeometry patch_geometry(const PatchScene& scene) {
    PatchGeometry geometry;
    for (const Patch& patch : scene.patches) {
        glm::dvec3 weighted{0.0}, corners{0.0}, normal{0.0};
        double area = 0;
        for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
            const glm::uvec3 corner = scene.triangles[t];
            const glm::dvec3 a = scene.positions[corner.x], b = scene.positions[corner.y],
                             c = scene.positions[corner.z];
            const glm::dvec3 twice_area = twice_area_vector(scene, t), middle = (a + b + c) / 3.0;
            const double twice = glm::length(twice_area);
            weighted += twice * middle;
            corners += middle;
            normal += twice_area;
            area += twice;
        }
        const double length = glm::length(normal);
        const glm::dvec3 mean = corners / double(std::max(patch.triangle_count, 1u));
        geometry.centres.push_back(glm::vec3(area > 0 ? weighted / area : mean));
        geometry.flatness.push_back(area > 0 ? float(length / area) : 1.f);
        geometry.normals.push_back(length > 0 ? glm::vec3(normal / length) : glm::vec3(0, 1, 0));
    }
    return geometry;
}

} // namespace kokage

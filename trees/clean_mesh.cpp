#include "trees/clean_mesh.h"

#include "common/geometry/triangle_topology.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

namespace kokage {

double triangle_area(const std::vector<glm::vec3>& positions, const glm::uvec3& triangle) {
    const glm::dvec3 a(positions[triangle.x]), b(positions[triangle.y]), c(positions[triangle.z]);
    return 0.5 * glm::length(glm::cross(b - a, c - a));
}

std::size_t drop_degenerate_and_back_faces(SceneMesh& mesh, bool drop_back_faces) {
    std::size_t back_faces = 0;
    const std::vector<std::uint32_t> welded = weld(mesh.positions);
    std::set<std::array<std::uint32_t, 3>> seen;
    std::vector<glm::uvec3> kept;
    kept.reserve(mesh.triangles.size());
    for (const glm::uvec3& t : mesh.triangles) {
        std::array<std::uint32_t, 3> corners{welded[t.x], welded[t.y], welded[t.z]};
        if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
            continue;
        if (drop_back_faces) {
            // Rotated so that the lowest comes first: the order of the other two tells the direction.
            std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
            const std::array<std::uint32_t, 3> reversed{corners[0], corners[2], corners[1]};
            if (seen.contains(reversed)) {
                ++back_faces;
                continue;
            }
            seen.insert(corners);
        }
        kept.push_back(t);
    }
    mesh.triangles = std::move(kept);
    return back_faces;
}

glm::vec3 mean_vertex_color(const SceneMesh& mesh) {
    glm::dvec3 sum(0.0);
    double weight = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const double area = triangle_area(mesh.positions, t);
        for (const std::uint32_t v : {t.x, t.y, t.z})
            sum += area * glm::dvec3(glm::clamp(glm::vec3(mesh.colors[v]), 0.f, 1.f));
        weight += 3 * area;
    }
    return weight > 0 && std::isfinite(sum.x + sum.y + sum.z) ? glm::vec3(sum / weight) : glm::vec3(1.f);
}

} // namespace kokage

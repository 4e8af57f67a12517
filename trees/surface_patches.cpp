#include "trees/surface_patches.h"

#include "common/geometry/triangle_topology.h"

#include <cmath>
#include <deque>

namespace kokage {
namespace {

struct Facet {
    glm::dvec3 normal{0.0}; ///< unit, or 0
    glm::dvec3 centroid{0.0};
    double area = 0;
};

std::vector<Facet> facets_of(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    std::vector<Facet> facets(triangles.size());
    for (std::size_t t = 0; t < triangles.size(); ++t) {
        const glm::dvec3 a(positions[triangles[t].x]), b(positions[triangles[t].y]), c(positions[triangles[t].z]);
        const glm::dvec3 cross = glm::cross(b - a, c - a);
        const double length = glm::length(cross);
        facets[t] = {length > 0 ? cross / length : glm::dvec3(0.0), (a + b + c) / 3.0, length / 2};
    }
    return facets;
}

} // namespace

std::vector<std::uint32_t> surface_patches(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles,
                                           const SurfacePatchLimits& limits) {
    const std::vector<Facet> facets = facets_of(positions, triangles);
    const Adjacency neighbours = triangle_neighbours(triangles, weld(positions));
    const std::vector<std::uint32_t> component = connected_components(neighbours);
    std::vector<std::uint32_t> component_size;
    for (const std::uint32_t c : component) {
        if (c >= component_size.size())
            component_size.resize(c + 1, 0);
        ++component_size[c];
    }
    const double cosine_limit = std::cos(double(limits.max_turn));
    std::vector<std::uint32_t> patch(triangles.size(), ~0u);
    std::uint32_t next = 0;
    std::deque<std::uint32_t> queue;
    for (std::size_t seed = 0; seed < triangles.size(); ++seed) {
        if (patch[seed] != ~0u)
            continue;
        const bool card = limits.keep_cards && component_size[component[seed]] <= 2;
        const bool whole_ring = limits.whole_rings && limits.whole_rings(glm::vec3(facets[seed].centroid));
        const double radius = double(limits.max_radius(glm::vec3(facets[seed].centroid)));
        const double area_limit = kPiDouble * radius * radius;
        glm::dvec3 normal_sum = facets[seed].normal * facets[seed].area;
        double area = facets[seed].area;
        patch[seed] = next;
        queue.assign(1, std::uint32_t(seed));
        while (!queue.empty()) { // breadth first, so that patches are compact
            const std::uint32_t t = queue.front();
            queue.pop_front();
            for (const std::uint32_t other : neighbours.of(t)) {
                const Facet& facet = facets[other];
                if (patch[other] != ~0u)
                    continue;
                const double length = glm::length(normal_sum);
                const bool turns = !whole_ring && facet.area > 0 && length > 0 &&
                                   glm::dot(facet.normal, normal_sum) < cosine_limit * length;
                const bool grows =
                    area + facet.area > area_limit || glm::distance(facet.centroid, facets[seed].centroid) > 2 * radius;
                if (turns || (grows && !card && facet.area > 0))
                    continue;
                patch[other] = next;
                normal_sum += facet.normal * facet.area;
                area += facet.area;
                queue.push_back(other);
            }
        }
        ++next;
    }
    return patch;
}

} // namespace kokage

#include "trees/keep_bark_area.h"

#include "common/geometry/triangle_topology.h"

namespace kokage {
namespace {

/// Where every vertex of a part goes when the bark grows by 1 m; vertices of no growing triangle stay.
std::vector<glm::dvec3> outward(const GrowingBark& bark) {
    const TreePart& part = bark.part;
    const std::vector<std::uint32_t> same = weld(part.positions);
    std::vector<glm::dvec3> normal(same.size(), glm::dvec3(0.0));
    std::vector<std::uint8_t> grows(same.size(), 0), held(same.size(), 0);
    for (std::size_t v = 0; v < same.size(); ++v)
        normal[same[v]] += glm::dvec3(part.normals[v]);
    for (std::size_t t = 0; t < part.triangles.size(); ++t)
        for (int c = 0; c < 3; ++c)
            (bark.may_grow[t] ? grows : held)[same[part.triangles[t][c]]] = 1;
    std::vector<glm::dvec3> direction(same.size(), glm::dvec3(0.0));
    for (std::size_t v = 0; v < same.size(); ++v) {
        const std::uint32_t own = same[v];
        const double length = glm::length(normal[own]);
        // Normals that cancel (both sides of a sheet) name no side to grow to.
        if (grows[own] && !held[own] && length > 1e-3)
            direction[v] = normal[own] / length;
    }
    return direction;
}

double area_when_moved(const TreePart& part, const std::vector<glm::dvec3>& direction, double by) {
    double area = 0;
    for (const glm::uvec3& t : part.triangles) {
        const glm::dvec3 a = glm::dvec3(part.positions[t.x]) + by * direction[t.x],
                         b = glm::dvec3(part.positions[t.y]) + by * direction[t.y],
                         c = glm::dvec3(part.positions[t.z]) + by * direction[t.z];
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

} // namespace

double keep_bark_area(std::vector<GrowingBark>& parts, double area, double furthest) {
    std::vector<std::vector<glm::dvec3>> directions;
    const auto area_at = [&](double by) {
        double sum = 0;
        for (std::size_t p = 0; p < parts.size(); ++p)
            sum += area_when_moved(parts[p].part, directions[p], by);
        return sum;
    };
    for (const GrowingBark& bark : parts)
        directions.push_back(outward(bark));
    if (area_at(0) >= area || !(furthest > 0))
        return 0;
    double low = 0, high = furthest;
    if (area_at(high) > area)
        for (int i = 0; i < 40; ++i) {
            const double middle = 0.5 * (low + high);
            (area_at(middle) < area ? low : high) = middle;
        }
    for (std::size_t p = 0; p < parts.size(); ++p)
        for (std::size_t v = 0; v < directions[p].size(); ++v)
            parts[p].part.positions[v] = glm::vec3(glm::dvec3(parts[p].part.positions[v]) + high * directions[p][v]);
    return high;
}

} // namespace kokage

#include "common/geometry/polygon.h"

#include <cmath>

namespace kokage {
namespace {

/// Twice the polygon's area times its normal (Newell's method, Sutherland et al. 1974).
glm::dvec3 newell_normal(std::span<const glm::dvec3> corners) {
    glm::dvec3 normal(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i)
        normal += glm::cross(corners[i] - corners[0], corners[(i + 1) % corners.size()] - corners[0]);
    return normal;
}

/// Corners in the plane of two axes, so that the polygon turns counter-clockwise.
std::vector<glm::dvec2> in_plane(std::span<const glm::dvec3> corners) {
    const glm::dvec3 normal = newell_normal(corners), size = glm::abs(normal);
    const std::size_t axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool turned = normal[axis] < 0;
    std::vector<glm::dvec2> plane;
    for (const glm::dvec3& corner : corners)
        plane.push_back(turned ? glm::dvec2(corner[v], corner[u]) : glm::dvec2(corner[u], corner[v]));
    return plane;
}

double turn(const glm::dvec2& a, const glm::dvec2& b, const glm::dvec2& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether the corner `at` of the ring is convex and no other corner lies in its triangle.
bool is_ear(const std::vector<glm::dvec2>& plane, const std::vector<std::uint32_t>& ring, std::size_t at) {
    const std::size_t n = ring.size();
    const glm::dvec2 &a = plane[ring[(at + n - 1) % n]], &b = plane[ring[at]], &c = plane[ring[(at + 1) % n]];
    if (!(turn(a, b, c) > 0))
        return false;
    for (std::size_t i = 2; i + 1 < n; ++i) {
        const glm::dvec2& p = plane[ring[(at + i) % n]];
        if (p != a && p != b && p != c && turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0)
            return false;
    }
    return true;
}

} // namespace

std::vector<glm::uvec3> triangulate_polygon(std::span<const glm::dvec3> corners) {
    std::vector<glm::uvec3> triangles;
    if (corners.size() < 3)
        return triangles;
    if (corners.size() == 3)
        return {glm::uvec3(0, 1, 2)};
    const std::vector<glm::dvec2> plane = in_plane(corners);
    std::vector<std::uint32_t> ring(corners.size());
    for (std::size_t i = 0; i < ring.size(); ++i)
        ring[i] = std::uint32_t(i);
    std::size_t at = 1, tried = 0; // so that a convex quad is cut from its first corner, as most programs do
    while (ring.size() > 3) {
        const std::size_t n = ring.size();
        // Without an ear the polygon crosses itself or is flat: any corner will do.
        if (tried < n && !is_ear(plane, ring, at)) {
            at = (at + 1) % n;
            ++tried;
            continue;
        }
        triangles.emplace_back(ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]);
        ring.erase(ring.begin() + std::ptrdiff_t(at));
        // Every second corner first, so that triangles do not all share one corner.
        at = (at + 1) % ring.size();
        tried = 0;
    }
    triangles.emplace_back(ring[0], ring[1], ring[2]);
    return triangles;
}

} // namespace kokage

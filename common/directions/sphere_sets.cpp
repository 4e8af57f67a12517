#include "common/directions/sphere_sets.h"
#include "common/directions/legendre.h"
#include "common/services/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>

namespace kokage {
namespace {

glm::dvec3 from_cylinder(double z, double azimuth) {
    const double radius = std::sqrt(std::max(0.0, (1 - z) * (1 + z)));
    return {radius * std::cos(azimuth), radius * std::sin(azimuth), z};
}

void require_positive(int n, const char* what) {
    if (n < 1)
        throw std::invalid_argument(std::string(what) + ": at least 1 is needed, not " + std::to_string(n));
}

/// Cells of equal area between z = top and z = bottom, in rings of about square cells; one jittered direction in each.
DirectionSet stratified_zone(int n, double top, double bottom, std::uint64_t seed) {
    DirectionSet set;
    const double area = 2 * kPiDouble * (top - bottom), side = std::sqrt(area / n);
    const double arc = std::acos(bottom) - std::acos(top);
    const int rings = std::clamp(int(std::lround(arc / side)), 1, n);
    int done = 0;
    for (int ring = 0; ring < rings; ++ring) {
        // Ideal ring borders at equal steps of the polar angle; the number of cells up to each is rounded, then the
        // border moves to fit it.
        const double ideal = std::cos(std::acos(top) + arc * (ring + 1) / rings);
        const int until =
            ring + 1 == rings ? n : std::clamp(int(std::lround(n * (top - ideal) / (top - bottom))), done, n);
        const int count = until - done;
        const double high = top - (top - bottom) * done / n, low = top - (top - bottom) * until / n;
        Random ring_random(seed, hash64(std::uint64_t(ring)));
        const double phase = ring_random.uniform_double();
        for (int i = 0; i < count; ++i) {
            Random random(seed, std::uint64_t(done + i));
            const double z = low + (high - low) * random.uniform_double();
            set.directions.push_back(from_cylinder(z, 2 * kPiDouble * (phase + i + random.uniform_double()) / count));
            set.weights.push_back(area / n);
        }
        done = until;
    }
    return set;
}

/// Solid angle of a spherical triangle: Van Oosterom and Strackee 1983, eq 8.
double triangle_solid_angle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return 2 * std::atan2(glm::dot(a, glm::cross(b, c)), 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

struct Icosahedron {
    std::array<glm::dvec3, 12> corners;
    std::array<std::array<int, 3>, 20> faces;
    Icosahedron() : corners(), faces() {
        const double golden = 0.5 * (1 + std::sqrt(5.0));
        std::size_t i = 0;
        for (int axis = 0; axis < 3; ++axis)
            for (const double one : {-1.0, 1.0})
                for (const double long_side : {-golden, golden}) {
                    glm::dvec3 corner(0);
                    corner[glm::length_t((axis + 1) % 3)] = one;
                    corner[glm::length_t((axis + 2) % 3)] = long_side;
                    corners[i++] = glm::normalize(corner);
                }
        // Faces are the triples of mutual neighbours, turned counter-clockwise.
        i = 0;
        auto neighbours = [&](int a, int b) {
            return glm::dot(corners[std::size_t(a)], corners[std::size_t(b)]) > 0.4;
        };
        for (int a = 0; a < 12; ++a)
            for (int b = a + 1; b < 12; ++b)
                for (int c = b + 1; c < 12; ++c)
                    if (neighbours(a, b) && neighbours(b, c) && neighbours(a, c)) {
                        const bool outwards =
                            glm::dot(corners[std::size_t(a)],
                                     glm::cross(corners[std::size_t(b)], corners[std::size_t(c)])) > 0;
                        faces[i++] = outwards ? std::array<int, 3>{a, b, c} : std::array<int, 3>{a, c, b};
                    }
    }
};

/// Vertices of the divided faces, shared along edges and at corners.
class DomeVertices {
  public:
    DomeVertices(const Icosahedron& base, int k) : base_(base), k_(k), edge_first_(12 * 12, -1) {
        directions.assign(base.corners.begin(), base.corners.end());
    }
    /// Vertex i steps from corner a towards b and j towards c, on face (a, b, c).
    std::uint32_t at(const std::array<int, 3>& face, std::vector<std::int64_t>& inside, int i, int j) {
        const int h = k_ - i - j;
        if (h == k_ || i == k_ || j == k_)
            return std::uint32_t(face[h == k_ ? 0 : i == k_ ? 1 : 2]);
        if (j == 0)
            return on_edge(face[0], face[1], i);
        if (i == 0)
            return on_edge(face[0], face[2], j);
        if (h == 0)
            return on_edge(face[1], face[2], j);
        std::int64_t& index = inside[std::size_t(i) * std::size_t(k_ + 1) + std::size_t(j)];
        if (index < 0) {
            index = std::int64_t(directions.size());
            directions.push_back(glm::normalize(double(h) * corner(face[0]) + double(i) * corner(face[1]) +
                                                double(j) * corner(face[2])));
        }
        return std::uint32_t(index);
    }
    std::vector<glm::dvec3> directions;

  private:
    const glm::dvec3& corner(int c) const { return base_.corners[std::size_t(c)]; }
    std::uint32_t on_edge(int a, int b, int step) {
        if (a > b)
            std::swap(a, b), step = k_ - step;
        std::int64_t& first = edge_first_[std::size_t(a * 12 + b)];
        if (first < 0) {
            first = std::int64_t(directions.size());
            for (int i = 1; i < k_; ++i)
                directions.push_back(glm::normalize(double(k_ - i) * corner(a) + double(i) * corner(b)));
        }
        return std::uint32_t(first + step - 1);
    }
    const Icosahedron& base_;
    int k_;
    std::vector<std::int64_t> edge_first_;
};

/// Adds to each corner the part of the triangle that is nearest to it.
void add_voronoi_areas(GeodesicDome& dome, const glm::uvec3& triangle) {
    std::array<glm::dvec3, 3> p;
    for (std::size_t i = 0; i < 3; ++i)
        p[i] = dome.directions[triangle[glm::length_t(i)]];
    const glm::dvec3 centre = glm::normalize(glm::cross(p[1] - p[0], p[2] - p[0])); // as far from all three
    for (std::size_t i = 0; i < 3; ++i) {
        const glm::dvec3 &a = p[i], &b = p[(i + 1) % 3], &c = p[(i + 2) % 3];
        dome.weights[triangle[glm::length_t(i)]] += triangle_solid_angle(a, glm::normalize(a + b), centre) +
                                                    triangle_solid_angle(a, centre, glm::normalize(a + c));
    }
}

} // namespace

DirectionSet fibonacci_sphere(int n) {
    require_positive(n, "fibonacci_sphere");
    DirectionSet set;
    const double golden = 0.5 * (1 + std::sqrt(5.0));
    for (int i = 0; i < n; ++i) {
        const double turns = i / golden;
        set.directions.push_back(from_cylinder(1 - (2.0 * i + 1) / n, 2 * kPiDouble * (turns - std::floor(turns))));
        set.weights.push_back(4 * kPiDouble / n);
    }
    return set;
}

DirectionSet gauss_rings(int degree) {
    if (degree < 0)
        throw std::invalid_argument("gauss_rings: the degree must not be negative");
    DirectionSet set;
    const int steps = degree + 1;
    for (const QuadratureNode& node : gauss_legendre(degree / 2 + 1))
        for (int i = 0; i < steps; ++i) {
            set.directions.push_back(from_cylinder(node.x, 2 * kPiDouble * i / steps));
            set.weights.push_back(2 * kPiDouble / steps * node.weight);
        }
    return set;
}

GeodesicDome geodesic_dome(int k) {
    require_positive(k, "geodesic_dome");
    const Icosahedron base;
    DomeVertices vertices(base, k);
    GeodesicDome dome;
    for (const auto& face : base.faces) {
        std::vector<std::int64_t> inside(std::size_t(k + 1) * std::size_t(k + 1), -1);
        for (int i = 0; i < k; ++i)
            for (int j = 0; i + j < k; ++j) {
                const std::uint32_t a = vertices.at(face, inside, i, j), b = vertices.at(face, inside, i + 1, j);
                const std::uint32_t c = vertices.at(face, inside, i, j + 1);
                dome.triangles.emplace_back(a, b, c);
                if (i + j + 1 < k)
                    dome.triangles.emplace_back(b, vertices.at(face, inside, i + 1, j + 1), c);
            }
    }
    dome.directions = std::move(vertices.directions);
    dome.weights.assign(dome.directions.size(), 0.0);
    for (const glm::uvec3& triangle : dome.triangles)
        add_voronoi_areas(dome, triangle);
    return dome;
}

DirectionSet stratified_sphere(int n, std::uint64_t seed) {
    require_positive(n, "stratified_sphere");
    return stratified_zone(n, 1, -1, seed);
}

DirectionSet stratified_hemisphere(int n, const glm::dvec3& axis, std::uint64_t seed) {
    require_positive(n, "stratified_hemisphere");
    DirectionSet set = stratified_zone(n, 1, 0, seed);
    // Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3.
    const double sign = std::copysign(1.0, axis.z), a = -1 / (sign + axis.z), b = axis.x * axis.y * a;
    const glm::dvec3 tangent(1 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        bitangent(b, sign + axis.y * axis.y * a, -axis.y);
    for (glm::dvec3& d : set.directions)
        d = glm::normalize(d.x * tangent + d.y * bitangent + d.z * axis);
    return set;
}

} // namespace kokage

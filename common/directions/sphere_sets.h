#pragma once
// Sets of directions on the sphere, with the solid angle that each stands for.
#include "common/types.h"

#include <cstdint>
#include <vector>

namespace kokage {

struct DirectionSet {
    std::vector<glm::dvec3> directions; ///< unit
    std::vector<double> weights;        ///< sr; they sum to 4 pi (2 pi for a hemisphere)
};

/// Fibonacci spiral around +Z: point i at z = 1 - (2i+1)/n and azimuth 2 pi i / golden ratio. Equal weights. n >= 1.
DirectionSet fibonacci_sphere(int n);

/// Gauss-Legendre nodes in z times equal steps in azimuth: integrates every polynomial (every spherical harmonic) of
/// degree <= `degree` exactly. Rings about +Z, from -Z upwards; degree/2 + 1 rings of degree + 1 directions.
DirectionSet gauss_rings(int degree);

/// Icosahedron whose edges are cut into k, pushed out to the sphere: 10 k^2 + 2 vertices, weights = areas of their
/// Voronoi cells.
struct GeodesicDome : DirectionSet {
    std::vector<glm::uvec3> triangles; ///< 20 k^2, counter-clockwise from outside
};
GeodesicDome geodesic_dome(int k);

/// n directions, each uniform in a cell of its own; the cells have equal area and are nearly square. Equal weights.
/// Depends on `seed` alone.
DirectionSet stratified_sphere(int n, std::uint64_t seed);
/// The same over the hemisphere around a unit axis.
DirectionSet stratified_hemisphere(int n, const glm::dvec3& axis, std::uint64_t seed);

} // namespace kokage

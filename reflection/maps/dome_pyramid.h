#pragma once
// [R] section 6: the image in four sizes, each resampled at the vertices of a geodesic dome. Rough lobes sum coarse
// domes.
#include "common/directions/sphere_sets.h"
#include "common/scene/image.h"
#include "common/types.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

inline constexpr int kDomeLevels = 4;
inline constexpr int kDomeEdges[kDomeLevels] = {72, 36, 18, 9};         ///< 51842, 12962, 3242, 812 vertices
inline constexpr int kPyramidWidths[kDomeLevels] = {512, 256, 128, 64}; ///< of the image that each dome samples

/// The symmetries that the icosahedron, so each dome, has in common with the cube: 24, a turn of the axes (x,y,z) ->
/// (x,y,z), (y,z,x) or (z,x,y), then any change of signs. Number: 8 x turn + sum of (1, 2, 4 where x, y, z changes).
inline constexpr int kDomeSymmetries = 24;

template <typename Vector>
Vector apply_symmetry(int symmetry, const Vector& v) {
    const int turn = symmetry / 8;
    Vector result = turn == 0 ? v : turn == 1 ? Vector(v.y, v.z, v.x) : Vector(v.z, v.x, v.y);
    for (int axis = 0; axis < 3; ++axis)
        if (symmetry >> axis & 1)
            result[glm::length_t(axis)] = -result[glm::length_t(axis)];
    return result;
}

/// The domes, made once a process.
struct Dome {
    GeodesicDome dome;
    /// vertex_of[symmetry][v]: where the symmetry takes vertex v.
    std::array<std::vector<std::uint16_t>, kDomeSymmetries> vertex_of;
};
const Dome& dome_of_level(int level);

/// Radiance at the vertices of the four domes.
using DomeLight = std::array<std::vector<glm::vec3>, kDomeLevels>;

/// Level 0 of the pyramid is the image reduced to 512 columns (one that is not wider as it is), each next level half
/// as wide, solid-angle means. A vertex takes its level's bilinear value. `image`: lat-long, finite.
DomeLight light_on_domes(const Image& image);

} // namespace kokage

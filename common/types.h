#pragma once
// Conventions of the whole house, written once.
//
//            +Y up                      Right-handed, +Y up, metres (as glTF).
//             |                         Directions are unit vectors that point AWAY from the point that is lit.
//             |                         A surface's front (+) is its counter-clockwise side after node transforms
//             o------ +X                (flipped where a transform's determinant is negative).
//            /                          Radiance: linear Rec.709, float RGB. Irradiance: the same unit times sr.
//          +Z                           Lat-long images: see common/environment/lat_long.h.
//                                       Spherical harmonics: see common/directions/spherical_harmonics.h.
#include <cstdint>
#include <glm/glm.hpp>

namespace kokage {

inline constexpr float kPi = 3.14159265358979323846f;
inline constexpr double kPiDouble = 3.14159265358979323846;

/// Relative luminance of a linear Rec.709 colour.
inline float luminance(const glm::vec3& rgb) {
    return 0.2126f * rgb.r + 0.7152f * rgb.g + 0.0722f * rgb.b;
}

} // namespace kokage

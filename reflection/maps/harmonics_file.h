#pragma once
// Spherical-harmonic coefficients of surroundings as JSON, for programs that light diffuse surfaces by them:
//
//   { "kind": "spherical harmonics", "version": 1,
//     "convention": "real orthonormal, index l(l+1)+m, no Condon-Shortley phase, +Y up, Y_1,-1..1 ~ y, z, x",
//     "quantity": "radiance", "bands": 3, "made_from": "...",
//     "coefficients": [[r, g, b], ...] }          bands² of them
//
// (common/directions/spherical_harmonics.h). Irradiance over pi of a surface: band 0 as it is, band 1 times 2/3, band 2
// times 1/4.
#include "common/types.h"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace kokage {

/// Whole or not at all; numbers read back bit by bit. Throws InputError for values that are not finite.
/// coefficients.size() is a square.
void write_harmonics(const std::filesystem::path& path, std::span<const glm::vec3> coefficients,
                     const std::string& made_from = "");
/// Throws InputError, one line that begins with the path, for whatever is not such a file.
std::vector<glm::vec3> read_harmonics(const std::filesystem::path& path);

} // namespace kokage

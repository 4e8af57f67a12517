#pragma once
// Spherical-harmonic coefficients of surroundings as JSON, for programs that light diffuse surfaces by them:
//
//   { "kind": "spherical harmonics", "version": 2,
//     "convention": "real orthonormal, index l(l+1)+m, no Condon-Shortley phase, +Y up, Y_1,-1..1 ~ y, z, x",
//     "quantity": "radiance",              or "irradiance"; colours are linear Rec.709
//     "unit": "of the image",              radiance; of irradiance "of the image x sr", pi under a sky of 1
//     "bands": 3, "made_from": "...",
//     "coefficients": [[r, g, b], ...],    bands² of them: l = 0; l = 1, m = -1, 0, 1; l = 2, m = -2 ... 2; ...
//     "lights": [ {"name": "sun", "direction": [x, y, z], "half_angle": 0.00465, "irradiance": [r, g, b]}, ... ] }
//
// The quantity in a unit direction (radiance: where from; irradiance: the normal) is the sum of coefficients times
// harmonics. Lights, if any are listed, are no part of the coefficients: each adds irradiance x max(0, direction .
// normal), shadowed by whatever the host knows. Nine coefficients of radiance become those of irradiance times pi
// (l = 0), 2 pi/3 (l = 1), pi/4 (l = 2). The first harmonics, for direction (x, y, z):
//
//     0.282095 | 0.488603 y, 0.488603 z, 0.488603 x | 1.092548 x y, 1.092548 y z, 0.315392 (3 z² - 1), 1.092548 x z,
//     0.546274 (x² - y²)
#include "reflection/maps/harmonics.h"

#include <filesystem>
#include <string>

namespace kokage {

/// Whole or not at all; numbers read back bit by bit. Throws InputError for values that are not finite.
void write_harmonics(const std::filesystem::path& path, const Harmonics& harmonics, const std::string& made_from = "");

struct HarmonicsFile {
    Harmonics harmonics;
    std::string made_from;
};
/// Throws InputError, one line that begins with the path, for whatever is not such a file.
HarmonicsFile read_harmonics(const std::filesystem::path& path);

} // namespace kokage

#pragma once
// Lights as a user writes them:
//
//     sun:AZIMUTH,ELEVATION,R,G,B                 disc of the sun's size; irradiance on a surface that faces it
//     disc:AZIMUTH,ELEVATION,R,G,B,HALF_ANGLE     disc of any half angle
//     directional:AZIMUTH,ELEVATION,R,G,B         parallel light
//     point:X,Y,Z,R,G,B                           at a place in metres; R,G,B is intensity (irradiance at distance d =
//     intensity / d^2)
//
// Angles in degrees: azimuth 0 = -Z (north), 90 = +X (east), elevation 90 = straight up (drawn in analytic_sky.h).
// R,G,B are linear Rec.709, not negative; one number instead of three is a grey. Example: sun:135,40,9,8.5,7
#include "common/environment/environment.h"

#include <string_view>
#include <variant>

namespace kokage {

/// Throws InputError that says what is wrong with which part, and what would be right.
std::variant<DistantLight, PointLight> parse_light(std::string_view description);

/// Parses and adds.
void add_light(Environment& environment, std::string_view description);

} // namespace kokage

#pragma once
// Surroundings without a file: daylight, constant, gradient.
#include "common/environment/environment.h"

namespace kokage {

/// Direction of an azimuth and an elevation, in degrees. Azimuth turns as on a map, elevation rises from the horizon:
///
///      seen from above             0 (north, -Z)                 from the side       90 (+Y)
///                                        |                                             |    .
///                     270 (west, -X) ----o---- 90 (east, +X)                           |  .   elevation
///                                        |                                             |.
///                                  180 (south, +Z)                         horizon ----o-------- 0
glm::vec3 direction_from_azimuth_elevation(double azimuth_degrees, double elevation_degrees);

/// Half the angle that the sun's disc spans, in degrees.
inline constexpr double sun_half_angle_degrees = 0.2666;

/// Daylight of Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 1999.
///   Unit: radiance 1 = 10,000 cd/m^2 (of the colour's luminance), so irradiance 1 = 10,000 lux: a noon sun gives about
///   10, a clear sky 1 to 2. The model ends at the horizon. Below it (our extension) the sky is that of the sun on the
///   horizon, times 10^(elevation / 2.9 degrees), which reaches a hundredth at the end of civil twilight (-6 degrees),
///   and stays at its value of -18 degrees; there is no sun light then.
struct Daylight {
    double sun_azimuth_degrees = 135;  ///< any finite value
    double sun_elevation_degrees = 45; ///< -90 ... 90
    double turbidity = 3;              ///< haze, 1.7 (the model's limit) ... 10: 2 very clear, 3 clear, 6 warm, 10 hazy
    int width = 512; ///< columns of the remainder; rows = width / 2, even, so that the horizon lies between two rows
};

/// Sky as the remainder (0 below the horizon, has_lower_half false) and the sun's disc as a light. Throws InputError
/// for parameters out of range.
Environment analytic_sky(const Daylight& daylight = {});

/// Radiance of the sky alone in a direction; 0 below the horizon.
glm::vec3 daylight_radiance(const Daylight& daylight, const glm::vec3& direction);
/// Irradiance of the sun on a surface that faces it, after the atmosphere; 0 when it is set.
glm::vec3 sun_irradiance(const Daylight& daylight);

/// The same radiance from everywhere.
Environment constant_environment(const glm::vec3& radiance);
/// Radiance that depends on the elevation alone: linear in sin(elevation) from nadir to horizon and from horizon to
/// zenith.
Environment gradient_environment(const glm::vec3& zenith, const glm::vec3& horizon, const glm::vec3& nadir);

} // namespace kokage

#pragma once
// A lat-long image on the faces of a cube, every texel the exact mean of what it covers.
#include "common/environment/environment.h"

#include <vector>

namespace kokage {

/// Mean radiance over the solid angle of every texel of a cube of 6 size² texels (prefiltered_cube.h's layout), of the
/// image taken as constant over each pixel: no sampling, so the integral over the sphere is kept and no pixel, however
/// small or bright, is missed or counted twice. At least 3 channels. Takes 24 bytes a pixel and a texel beside; CPU in
/// README.
std::vector<glm::vec3> cube_from_lat_long(const Image& image, int size);

/// Adds lights at infinity to such texels: discs evenly over what they cover of each (to 1 %), a bare direction to the
/// one texel that it meets. The light that they bring in all is kept.
void add_lights_to_cube(std::vector<glm::vec3>& texels, int size, const std::vector<DistantLight>& lights);

} // namespace kokage

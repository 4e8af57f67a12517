#pragma once
// Lat-long (equirectangular) images, as three.js reads them:
//
//        u = 0.5 + atan2(z, x) / 2pi          u=0        u=0.5       u=1
//        v = acos(y) / pi                 v=0  +--- +Y (all of the row) ---+
//                                              |  -X    -Z    +X    +Z  -X |
//        top row = +Y                     v=1  +--- -Y --------------------+
//
// Held against three.js itself by tests/unit/common/lat_long_three_test.cpp.
#include "common/scene/image.h"
#include "common/types.h"

namespace kokage {

/// Texture coordinates of a unit direction, u in [0,1), v in [0,1].
glm::vec2 lat_long_from_direction(const glm::vec3& direction);
/// Unit direction of texture coordinates.
glm::vec3 direction_from_lat_long(glm::vec2 uv);
/// Unit direction of a pixel's centre.
glm::dvec3 pixel_direction(int x, int y, int width, int height);
/// Exact solid angle in sr of every pixel of row y: (2pi/width) (cos(theta_top) - cos(theta_bottom)).
double pixel_solid_angle(int y, int width, int height);
/// Bilinear lookup, wrapping in u and clamping at the poles. The image has at least 3 channels.
glm::vec3 lat_long_radiance(const Image& image, const glm::vec3& direction);
/// Shrinks to `width` columns (rows in proportion, at least 1): every new pixel is the solid-angle mean of what it
/// covers, so the integral over the sphere is kept, of every channel. An image that is not wider is returned as it is.
Image reduce_lat_long(Image image, int width);
/// Divides pixels that are wider than high at the equator into square ones: for whoever takes a pixel for a point.
Image with_square_pixels(Image image);

} // namespace kokage

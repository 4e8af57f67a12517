#pragma once
// Height maps that tile: how far one is from it, and making it so.
#include "common/scene/image.h"

#include <glm/glm.hpp>

namespace kokage {

/// How far a map is from tiling along u (over its left and right edge) and v: the root mean square of the steps over
/// the edge, divided by that of the steps between neighbours within. About 1: it tiles. Several: a seam shows. A map
/// without any steps, or of one texel along the axis: 1. `heights` has one channel.
glm::dvec2 seam_steps(const Image& heights);

/// From this on a map is said not to tile.
inline constexpr double kSeamShows = 3;

/// The map's periodic part, after L. Moisan, Periodic plus Smooth Image Decomposition (2011), eqs 10 to 12: the map
/// less that smooth one (its Laplacian is 0 but for the edges) which has the same steps over the edges. Details within
/// stay as they are, the size too; the mean too; values may leave the range that they had. A map that tiles already
/// changes by less than a step between its texels, along its edges.
Image periodic_part(const Image& heights);

} // namespace kokage

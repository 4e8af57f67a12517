#pragma once
#include "common/types.h"

#include <span>
#include <vector>

namespace kokage {

/// Triangles of a polygon in space, convex or concave, as indices of its corners; they turn as the polygon does. By
/// cutting ears (Meisters, "Polygons have ears", 1975) in the plane of its mean normal; a polygon that crosses itself
/// or has no area still gives corners.size() - 2 triangles. None for fewer than 3 corners.
std::vector<glm::uvec3> triangulate_polygon(std::span<const glm::dvec3> corners);

} // namespace kokage

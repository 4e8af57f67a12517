#pragma once
#include "common/types.h"

#include <span>
#include <vector>

namespace kokage {

/// Triangles of a simple polygon (counter-clockwise, at least 3 corners, no holes), counter-clockwise, as indices of
/// its corners: ears are cut one after the other (Meisters 1975), always the one whose smallest angle is largest, so
/// that few are slender. Cubic time: for outlines of leaves. Throws std::logic_error if no ear is found, as in a
/// clockwise polygon.
std::vector<glm::uvec3> triangulate_polygon(std::span<const glm::vec2> corners);

} // namespace kokage

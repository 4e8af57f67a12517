#pragma once
// Which points of a set are the farthest in given directions: those that its outline is told by.
#include "common/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

/// Indices of the points that are farthest along at least one of the directions (which need not be unit vectors),
/// ascending, each once; where rounding makes two equally far, one of them. Points that are not finite are left out.
std::vector<std::uint32_t> support_points(std::span<const glm::vec3> points, std::span<const glm::vec3> directions);

} // namespace kokage

#pragma once
// Finer triangles of the same shape: for what holds one value a triangle, or a vertex.
#include "common/types.h"

#include <utility>
#include <vector>

namespace kokage {

/// Splits edges longer than `longest` at their middles, again and again, until none is left or there are more than
/// `most` triangles. An edge is judged by its ends alone, so neighbours split alike and no cracks open, also along
/// seams where vertices are doubled. New vertices come after the old ones; `middles` tells between which two each lies
/// (their own middles come before them), and `source` the triangle that each triangle is a piece of, in order.
void split_long_edges(double longest, std::size_t most, std::vector<glm::vec3>& positions,
                      std::vector<glm::uvec3>& triangles, std::vector<std::pair<std::uint32_t, std::uint32_t>>& middles,
                      std::vector<std::uint32_t>& source);

} // namespace kokage

#pragma once
#include "common/types.h"

#include <vector>

namespace kokage {

/// The vertices of a growing scene; uvs may be empty.
struct VertexArrays {
    std::vector<glm::vec3>& positions;
    std::vector<glm::vec3>& normals;
    std::vector<glm::vec2>& uvs;
};

/// Cuts a leaf into up to 4^levels pieces of about equal area, each a run of triangles that lie together: halved again
/// and again across its longest extent, after bisecting triangles that are too large to share out. New vertices (edge
/// midpoints) are appended to `vertices`. A leaf without area stays one piece.
std::vector<std::vector<glm::uvec3>> subdivide_leaf(std::vector<glm::uvec3> triangles, int levels,
                                                    VertexArrays vertices);

} // namespace kokage

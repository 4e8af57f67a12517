#pragma once
// Normals of a mesh that tells none: smooth over what bends gently, sharp along its creases.
#include "common/types.h"

#include <vector>

namespace kokage {

struct CreasedMesh {
    std::vector<glm::vec3> positions, normals; ///< unit; a vertex on a crease stands there once for each of its sides
    std::vector<glm::uvec3> triangles;         ///< in the given order
};

/// A corner's normal is the mean, by area, of its vertex' triangles that turn from its own by no more than `angle`
/// radians (of all of them at a vertex of more than 256). Triangles without area take part in no mean and get what
/// their neighbours have, or +Y. Throws InputError for indices out of range.
CreasedMesh crease_normals(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles,
                           float angle);

} // namespace kokage

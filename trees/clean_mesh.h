#pragma once
// What a mesh of a stranger's file needs before it becomes a part of a tree. Private to trees.
#include "common/scene/mesh_scene.h"

#include <cstddef>

namespace kokage {

/// Drops triangles whose corners coincide, and of two triangles with the same corners in opposite directions (a sheet
/// drawn twice for viewers that cull back faces) the second: leaves are two-sided here. Returns how many were dropped
/// for that.
std::size_t drop_degenerate_and_back_faces(SceneMesh& mesh, bool drop_back_faces);

/// The mean over the mesh's area, of values cut to 0..1; white where that is no number.
glm::vec3 mean_vertex_color(const SceneMesh& mesh);

double triangle_area(const std::vector<glm::vec3>& positions, const glm::uvec3& triangle);

} // namespace kokage

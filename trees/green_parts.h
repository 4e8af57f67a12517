#pragma once
// Foliage told by its colour alone: for trees whose one material holds leaves and bark (palette textures, vertex
// colours). Private.
#include "common/gltf/gltf_scene.h"

namespace kokage {

/// True for a linear colour in which green leads by a twentieth.
bool is_green(const glm::vec3& color);

/// For each triangle of a mesh, whether it is green: base colour times texture times vertex colours at its middle.
/// Where the mesh has several connected pieces, each piece is judged as a whole, by area.
std::vector<bool> green_triangles(const SceneMesh& mesh, const SceneMaterial& material);

/// Share of the mesh's area that is green, 0..1.
double green_share(const SceneMesh& mesh, const std::vector<bool>& green);

/// Takes the chosen triangles out of `mesh` into a mesh of their own; both keep all vertices.
SceneMesh take_triangles(SceneMesh& mesh, const std::vector<bool>& chosen);

} // namespace kokage

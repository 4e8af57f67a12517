#pragma once
// The triangles that relief lies on, as a renderer has them: of a tree's bark, or of any object.
#include "common/types.h"

#include <span>
#include <string_view>
#include <vector>

namespace kokage {

/// Views of somebody's arrays. The counter-clockwise side is the outside. One texture coordinate of 1 is one tile; v
/// grows downwards in the image. Vertices are split where texture coordinates or normals jump.
struct ReliefMesh {
    std::span<const glm::vec3> positions; ///< metres
    std::span<const glm::vec3> normals;   ///< unit, outwards; as long as positions
    std::span<const glm::vec2> uvs;       ///< as long as positions
    std::span<const glm::uvec3> triangles;
};

/// Throws InputError, which begins with `name`, where texture coordinates are missing (relief can't guess how its tile
/// shall lie: give the mesh some), arrays differ in length, corners are out of range, or numbers are not finite.
void check_relief_mesh(const ReliefMesh& mesh, std::string_view name);

/// A number for each vertex: the same for all that lie at the same place, in order of first appearance.
struct WeldedPlaces {
    std::vector<std::uint32_t> place_of_vertex;
    std::uint32_t count = 0;
};
WeldedPlaces weld_places(std::span<const glm::vec3> positions);

} // namespace kokage

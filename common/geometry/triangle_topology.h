#pragma once
// Which triangles and vertices of a triangle soup belong together. Exporters split vertices along seams of normals and
// texture coordinates, so vertices at exactly the same place are taken as one. Meshes of foreign trees are often
// non-manifold (crossed cards, several sheets on one edge), which half-edge structures such as OpenMesh refuse; plain
// adjacency does not mind.
#include "common/types.h"

#include <span>
#include <vector>

namespace kokage {

/// Compressed rows: neighbours of item i are items[first[i] .. first[i+1]).
struct Adjacency {
    std::vector<std::uint32_t> first, items;
    std::span<const std::uint32_t> of(std::size_t i) const {
        return std::span(items).subspan(first[i], first[i + 1] - first[i]);
    }
};

/// For each position the lowest index of a position with the same coordinates (-0 equals 0).
std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions);

/// Triangles that share an edge of welded vertices. An edge with more than 8 triangles joins them as a chain.
Adjacency triangle_neighbours(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> welded);

/// Welded vertices that share an edge; rows of vertices that are not their own representative are empty.
Adjacency vertex_neighbours(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> welded);

/// The component of every item, numbered by their first item.
std::vector<std::uint32_t> connected_components(const Adjacency& adjacency);

} // namespace kokage

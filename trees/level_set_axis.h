#pragma once
// Thinning by level sets of a distance along the surface. Private to trees.
#include "trees/bark_axis.h"

namespace kokage {

/// What BarkMesh::axis_tree does, once distances from the tip are known. The arrays are a whole mesh's, one element a
/// vertex.
struct LevelSetAxis {
    std::span<const glm::vec3> positions;
    const Adjacency& neighbours;
    std::span<const float> distance;
    std::span<std::uint32_t> set_of; ///< to work with

    /// The axis of the piece that `vertices` make, in levels of `width`, beginning at the vertex `base`.
    std::vector<AxisNode> tree(std::span<const std::uint32_t> vertices, float width, std::uint32_t base) const;
};

} // namespace kokage

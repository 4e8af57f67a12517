#pragma once
// The axes of bark: each connected piece thinned to a tree of points. Private to trees.
#include "common/geometry/triangle_topology.h"

#include <array>
#include <limits>
#include <optional>
#include <span>

namespace kokage {

/// A connected piece of bark.
struct BarkPiece {
    std::vector<std::uint32_t> vertices; ///< one index for each place
    double area = 0;
    double thickness = 0; ///< radius of the tube that has its area and length
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

/// A point of a piece's axis. Parents come before children; the first has no parent.
struct AxisNode {
    glm::vec3 position{0.f};
    float radius_m = 0;
    std::uint32_t parent = ~0u;
    std::vector<std::uint32_t> children;
    float reach = 0; ///< length of the longest way from here to a tip
};

/// Where a piece ends.
struct BarkEnd {
    std::uint32_t vertex = 0;
    glm::vec3 centre{0.f};
    float radius_m = 0;
};

/// The axis of a piece that is one tube, as a chain; parents and children are set from the first to the last.
struct TubeAxis {
    std::vector<AxisNode> nodes; ///< at least 2; the thicker end first
    float base_radius_m = 0;     ///< the largest, single bumps left out
};

/// Turns a chain of axis nodes round.
void reverse_chain(std::vector<AxisNode>& nodes);

class BarkMesh {
  public:
    /// The arrays must outlive it.
    BarkMesh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles);

    const std::vector<BarkPiece>& pieces() const { return pieces_; }
    const glm::vec3& position(std::uint32_t vertex) const { return positions_[vertex]; }

    /// The two ends that lie farthest apart along the surface.
    std::array<BarkEnd, 2> ends(const BarkPiece& piece);

    /// Most tools make a branch of rings of vertices, each joined to the next alone. Then rings are what lies equally
    /// many edges from the tip (or from the rim of an open end), and their centres are the axis, exactly. Empty if the
    /// piece is not made so.
    std::optional<TubeAxis> tube_axis(const BarkPiece& piece);

    /// The axis tree of a piece, beginning at `base` (a vertex of the piece). Level sets of the distance along the
    /// surface, at their centroids (Verroust and Lazarus 1999). Distance is taken from the tip farthest from the base:
    /// around a thin tip all rails of a tube are equally long, around a thick base they are not, and slanted level sets
    /// would look like forks. Loops of level sets, which no tree has, are closed by joining the sets; points nearer to
    /// each other than the wood is thick become one.
    std::vector<AxisNode> axis_tree(const BarkPiece& piece, std::uint32_t base);

  private:
    void find_pieces(std::span<const glm::uvec3> triangles);
    void find_rims(std::span<const glm::uvec3> triangles);
    std::vector<std::uint32_t> rim_of(std::uint32_t vertex, const BarkPiece& piece);
    std::vector<std::vector<std::uint32_t>> rings_from(const std::vector<std::uint32_t>& start, const BarkPiece& piece);
    void measure_distances(std::uint32_t from, const BarkPiece& piece);
    std::uint32_t furthest_vertex(const BarkPiece& piece) const;

    std::span<const glm::vec3> positions_;
    std::vector<std::uint32_t> welded_;
    Adjacency neighbours_;
    Adjacency rims_; ///< neighbours along edges of one triangle
    std::vector<BarkPiece> pieces_;
    std::vector<float> distance_;        ///< per vertex, within the piece at work
    std::vector<std::uint32_t> node_of_; ///< per vertex, within the piece at work
};

} // namespace kokage

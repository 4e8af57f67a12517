#pragma once
// The space between a mesh and the same mesh moved inwards, where relief lies, cut into tetrahedra.
//
//        a0 ________ a1     Every triangle of the mesh (a: the reference plane, depth 0) is the top of a prism whose
//          |\ `·.   |       bottom (b: depth 1) are its corners moved inwards along the normals of their places. Three
//          | `·. `· |       tetrahedra fill it: a0 a1 a2 b2, a0 a1 b1 b2, a0 b0 b1 b2, with its corners sorted by
//          place,
//          |_____`·.|       so that neighbouring prisms cut their common side along the same diagonal and the
//        b0         b1      tetrahedra leave no gap and no overlap.
//
// Over one tetrahedron texture coordinates and depth are linear, so that a straight ray is straight in relief space as
// well; from one to the next it bends as the surface does. That is S. Porumbescu et al., Shell Maps, SIGGRAPH 2005
// (§4, "a piecewise linear map"), and what passes all of it passes the silhouette.
//
// Places are the mesh's vertices welded by position, so prisms meet at seams of texture coordinates and normals too.
#include "reflection/relief/relief_mesh.h"

#include <array>
#include <cstdint>

namespace kokage {

/// How deep relief goes below a mesh.
struct ReliefDepth {
    float depth_m = 0.01f; ///< of depth 1, >= 0
    /// The size of a tile that this depth was made for, metres: where the mesh's tiles are smaller (texture that
    /// narrows along branches), depth shrinks with them. 0: the depth holds everywhere.
    float tile_m = 0;
    float most_of_radius = 0.25f; ///< relief is no deeper than this share of the radius of what is convex (0 .. 0.5)
};

/// Bark of one tree may have several reliefs (layers), a coarse one at the foot and fine ones above: the shell is
/// common to all, so that rays go from one to the next. A layer of depth 0 has no relief: its triangles are solid.
struct ReliefLayers {
    std::vector<ReliefDepth> depths;
    std::vector<std::uint8_t> of_triangle; ///< index in depths; empty: all are of the first
};

struct ReliefShell {
    /// A prism. Its own corners k = 0, 1, 2 are the triangle's in ascending order of their places.
    struct Prism {
        glm::uvec3 places{0};
        std::array<glm::vec2, 3> uvs{};
        std::array<std::uint8_t, 3> corners{}; ///< which corner of the triangle k is
        std::uint8_t layer = 0;
        bool is_solid = false; ///< has no room for relief: rays end at it
        /// Across the sides over corners 01, 02, 12: prism << 2 | its side there (0, 1, 2 for 01, 02, 12); or kBorder.
        std::array<std::uint32_t, 3> neighbors{};
    };
    static constexpr std::uint32_t kBorder = 0xffffffffu;

    std::vector<glm::vec3> outer, inner; ///< of each place: depth 0 and depth 1
    std::vector<Prism> prisms;           ///< one for each triangle
    std::size_t shallow_places = 0;      ///< where depth had to shrink below what was asked for so that no prism folds

    float thickness_m(const Prism& prism, const glm::vec3& weights) const; ///< weights of the prism's own corners
    std::size_t bytes() const;
};

/// Checks the mesh (check_relief_mesh). Throws InputError where a depth is negative or not finite. Where layers meet,
/// the shallower one's depth holds (a solid one's does not count). Triangles without area are left out of the
/// neighbourhoods where two of their corners are one place, and solid else.
ReliefShell make_relief_shell(const ReliefMesh& mesh, const ReliefLayers& layers, std::string_view name);
ReliefShell make_relief_shell(const ReliefMesh& mesh, const ReliefDepth& depth, std::string_view name);

/// The place of depth `depth` under the point of a prism that has `weights` of its own corners.
glm::dvec3 shell_point(const ReliefShell& shell, const ReliefShell::Prism& prism, const glm::dvec3& weights,
                       double depth);

} // namespace kokage

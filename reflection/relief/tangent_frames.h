#pragma once
// How tiles of texture lie on a mesh: smooth tangent frames from texture coordinates, with the metres of a tile.
//
// In the manner of MikkTSpace (M. Mikkelsen, Simulation of Wrinkled Surfaces Revisited, 2008, §3.3): the triangles'
// derivatives, laid into the tangent plane of the corner's normal and averaged by the angle at the corner, over the
// triangles that share place, normal, texture coordinate and handedness. Beyond it: coordinates that differ by whole
// tiles are the same (a trunk's seam is smooth), and u and v need not be at right angles.
#include "reflection/relief/height_field.h"
#include "reflection/relief/relief_mesh.h"

#include <cstdint>

namespace kokage {

struct TangentFrame {
    /// ∂P/∂u and ∂P/∂v: where one tile leads, metres, at right angles to the normal. Both 0 where texture coordinates
    /// have no area (relief has no slope there).
    glm::vec3 along_u{0.f}, along_v{0.f};
    glm::vec3 normal{0, 1, 0}; ///< unit

    bool has_tangents() const { return along_u != glm::vec3(0.f); }
};

/// Corners of triangles share frames where they may.
struct TangentFrames {
    std::vector<TangentFrame> frames;
    std::vector<glm::uvec3> corners; ///< of each triangle: indices of frames
};
TangentFrames make_tangent_frames(const ReliefMesh& mesh);

/// Of a triangle at the weights of its corners; not renormalised but for the normal.
TangentFrame interpolate(const TangentFrames& frames, std::size_t triangle, const glm::vec3& weights);

/// What relief of `depth_m` measures in a frame.
ReliefScale relief_scale(const TangentFrame& frame, float depth_m);

/// Unit normal of relief of a slope (∂depth/∂u, ∂depth/∂v, per tile) in a frame.
glm::vec3 relief_normal(const TangentFrame& frame, const glm::vec2& slope, float depth_m);

/// Metres of a tile at every welded place: the mean over its triangles, by their area, of √|∂P/∂u × ∂P/∂v|; 0 where
/// texture coordinates have no area.
std::vector<float> tile_sizes(const ReliefMesh& mesh, const WeldedPlaces& places);

} // namespace kokage

#pragma once
// Relief on a mesh: what a ray that has reached the mesh hits below it.
//
// A renderer finds where a ray meets the mesh (its outside), then asks here. The ray goes on through the tetrahedra of
// the ReliefShell, straight in relief space within each; a ReliefTracer finds the first hit there, for many rays at
// once. A ray that comes out of the shell again has passed the silhouette: the renderer goes on with whatever it meets
// behind, also this mesh once more (it bends), from its entry on. Where meshes pass through one another (a branch's
// foot in its trunk) the nearest hit of all counts.
#include "reflection/relief/relief_shell.h"
#include "reflection/relief/relief_tracer.h"
#include "reflection/relief/tangent_frames.h"

#include <limits>

namespace kokage {

/// A ray that has reached the outside of the mesh.
struct SurfaceRay {
    glm::vec3 origin{0.f}, direction{0, 0, 1}; ///< unit length, metres
    std::uint32_t triangle = 0;                ///< that it has reached
    float distance = 0;                        ///< from the origin to there
    /// 1: the full relief; less: flatter; 0: none, the hit is the mesh's own (relief_strength).
    float strength = 1;
};

struct SurfaceHit {
    float distance = std::numeric_limits<float>::infinity(); ///< from the ray's origin; infinity: it came out again ...
    float way_out = 0;                                       ///< ... at this distance; through a border of the mesh too
    glm::vec3 position{0.f};                                 ///< metres
    glm::vec3 geometric_normal{0.f};                         ///< unit, of the relief as it is traced, outwards
    glm::vec3 shading_normal{0.f}; ///< unit, of the relief on the smooth surface that the mesh's normals tell of
    glm::vec2 uv{0.f};             ///< as the mesh's
    std::uint32_t triangle = 0;    ///< under which it lies, perhaps not the one where the ray came in
    glm::vec3 weights{0.f};        ///< of its corners, for anything else that they hold
    float depth = 0;               ///< 0 .. strength
    float depth_m = 0;             ///< below the mesh
    float thickness_m = 0;         ///< of depth 1 there
    float strength = 1;            ///< as the ray's
    std::uint32_t reads = 0;       ///< of heights and their bounds, as ReliefHit's
    std::uint32_t tetrahedra = 0;  ///< passed

    bool found() const { return distance < std::numeric_limits<float>::infinity(); }
};

/// How strong relief shall be where its greatest depth covers `pixels` on the picture: none below a quarter of a pixel,
/// full from three quarters on, smoothly between, so that nothing pops.
float relief_strength(float pixels);

/// Relief of one layer of the shell.
struct SurfaceReliefLayer {
    const ReliefTracer* tracer = nullptr; ///< of relief that fills the tile that texture coordinates tell
    float least_depth = 0;                ///< of that relief, 0 if not known: rays above it are not traced
};

class SurfaceRelief {
  public:
    /// All are kept by reference. Throws std::invalid_argument where a layer of the shell that is not solid has none.
    SurfaceRelief(const ReliefShell& shell, const TangentFrames& frames, std::vector<SurfaceReliefLayer> layers);
    SurfaceRelief(const ReliefShell& shell, const TangentFrames& frames, const ReliefTracer& tracer);

    /// First hits; `hits` has as many elements as `rays`. A ray that meets a triangle from inside, or one without room
    /// for relief, hits it there. Each result is the same whatever rays are beside it; the calling thread alone works.
    void trace(std::span<const SurfaceRay> rays, std::span<SurfaceHit> hits) const;

    /// From hits of trace() in `to_light` (unit), one a hit: 1 where relief hides the light. Where not, `ways_out`
    /// tells how far from the hit the ray leaves the shell: other things may hide the light from there on.
    void occluded(std::span<const SurfaceHit> hits, std::span<const glm::vec3> to_light, std::span<std::uint8_t> hidden,
                  std::span<float> ways_out) const;

    /// What rays from hits of trace() meet next within the shell, as trace() tells it; `distance` and `way_out` count
    /// from the hit. A hit on the mesh itself (thickness 0) stops what goes on behind it.
    void trace_on(std::span<const SurfaceHit> from, std::span<const glm::vec3> directions,
                  std::span<SurfaceHit> hits) const;

    const ReliefShell& shell() const { return shell_; }

  private:
    struct Walk;
    struct Wave;
    void step(Wave& wave, std::vector<Walk>& walks) const;
    Walk from_outside(const SurfaceRay& ray) const;
    Walk from_hit(const SurfaceHit& hit, const glm::vec3& direction) const;
    void follow(std::vector<Walk>& walks) const;
    SurfaceHit hit_of(const Walk& walk, const SurfaceRay& ray) const;

    const ReliefShell& shell_;
    const TangentFrames& frames_;
    std::vector<SurfaceReliefLayer> layers_;
};

} // namespace kokage

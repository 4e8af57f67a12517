#pragma once
// How a scene changes the light of the sky on the ground under it: what it hides, and what it scatters down.
#include "common/services/progress.h"
#include "common/trace/ray_queries.h"
#include "reflection/backdrop.h"
#include "reflection/picture.h"

#include <vector>

namespace kokage {

/// Irradiance on a horizontal plane, from everything but the split-off lights, kept on nested square grids:
///
///     +---------------+      The coarsest reaches 8 scene radii; each next one is half as wide with as many nodes,
///     down to 1/32 |   +-------+   |      of the widest, centred where the scene stands on the ground. Where grids
///     overlap the finer one is |   | +---+ |   |      taken, blended into the coarser one over its outer fifth; the
///     coarsest fades to the open sky. |   | +---+ |   |
///     +---+-------+---+      Between nodes: cubic B-spline.
///
/// Every node holds E(node) - E(open sky): rays that reach the sky have no part in it, so it has no noise far from the
/// scene. All nodes share one set of cosine-distributed directions, so what error there is varies as smoothly as the
/// shadow itself.
class GroundSkyLight {
  public:
    GroundSkyLight(const ShadedScene& scene, const RayQueries& queries, const Backdrop& backdrop, float height,
                   Progress& progress);

    /// In radiance x sr, at a place of the plane; never negative.
    glm::vec3 irradiance(float x, float z) const;
    /// The same without a scene.
    static glm::vec3 open_irradiance(const Backdrop& backdrop);

  private:
    struct Level {
        glm::vec2 centre; ///< x and z
        float half_width;
        std::vector<glm::vec3> nodes; ///< kNodes x kNodes, rows along x
        float weight(const glm::vec2& place) const;
        glm::vec2 node_place(int column, int row) const;
        glm::vec3 interpolated(const glm::vec2& place) const;
    };
    void place_levels(const PatchScene& patches);
    void gather(const ShadedScene& scene, const RayQueries& queries, const Backdrop& backdrop, float height,
                Progress& progress);
    bool hidden_by_finer(std::size_t level, int column, int row) const;

    std::vector<Level> levels_; ///< coarsest first; empty without a scene
    glm::vec3 open_{0.f};
};

} // namespace kokage

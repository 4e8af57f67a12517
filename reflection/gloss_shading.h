#pragma once
// What a surface's gloss shows a camera, split-off lights apart: surroundings through its lobe, and the scene where it
// stands in front of them.
#include "reflection/glossy_light.h"
#include "reflection/ground_shading.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

/// The lobe is looked up in a multi-scale map as if nothing stood in the way; one ray drawn from the lobe for every
/// camera ray corrects it: where it meets the scene, what it meets replaces the surroundings behind it. So the map
/// carries what varies little, rays only the difference, and without anything in the way there is no noise.
class GlossShading {
  public:
    /// Bakes `lobes` (gloss_in_view.h; empty: all that is in view is matt), and says in the report what that was. All
    /// must outlive it.
    GlossShading(const RayQueries& queries, const Environment& environment, const SurfaceShading& surfaces,
                 const GroundLook& ground, const GroundShading& ground_light,
                 const std::optional<RoughnessBounds>& lobes, Progress& progress, WorkReport& report);

    /// K times the light through the lobe. A single ray's answer may be negative; their mean is not.
    glm::vec3 radiance(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                       ShadingScratch& scratch) const;

  private:
    glm::vec3 seen_along(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample,
                         ShadingScratch& scratch, bool& met) const;

    const RayQueries& queries_;
    const Environment& environment_;
    const SurfaceShading& surfaces_;
    const GroundLook& ground_;
    const GroundShading& ground_light_;
    std::optional<GlossyRemainder> remainder_; ///< empty: no gloss is drawn by itself
};

} // namespace kokage

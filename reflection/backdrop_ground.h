#pragma once
// The ground that the lower half of an environment's image shows: how the scene that stands on it changes its light.
// Private to reflection.
#include "reflection/ground_look.h"

namespace kokage {

/// What the image shows below the horizon was lit by its upper half. A camera at the height from which it was taken
/// sees every point of the ground in the direction in which the image has it, so only the light on it changes: times
/// (light with the scene) / (light without it). Far from the scene that tends to 1 and is made 1, because there the
/// image shows things that stand, not ground. Nor do lamps change, and what is brighter than all light that comes down
/// could make it: that shines by itself.
class BackdropGround {
  public:
    /// `look` must outlive it, and be of a backdrop.
    BackdropGround(const Environment& environment, const Backdrop& backdrop, const GroundLook& look);

    /// Its radiance is `unchanged` + `albedo` / pi x (irradiance with the scene).
    struct Share {
        glm::vec3 unchanged{0.f}, albedo{0.f}; ///< albedo is at most 1
    };
    /// What the image shows there: without the split-off lights, and those of them that are seen.
    Share share(const glm::vec3& point, const glm::vec3& shown, const glm::vec3& lights) const;

    const GroundLook& look() const { return look_; }

  private:
    const GroundLook& look_;
    glm::vec3 open_irradiance_{0.f}; ///< upwards, from what is in the image: lights that were added are not
};

} // namespace kokage

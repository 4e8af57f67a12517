#pragma once
// The ground that the lower half of an environment's image shows: how the scene that stands on it changes its light.
// Private to reflection.
#include "reflection/ground_look.h"

namespace kokage {

/// What the image shows below the horizon was lit by its upper half. A camera at the height from which it was taken
/// sees every point of the ground in the direction in which the image has it, so only the light on it changes: times
/// (light with the scene) / (light without it). Far from the scene that tends to 1 and is made 1, because there the
/// image shows things that stand, not ground. Nor does a ground change that shines by itself, under a black sky.
class BackdropGround {
  public:
    /// `look` must outlive it, and have a height and no albedo.
    BackdropGround(const Environment& environment, const Backdrop& backdrop, const GroundLook& look);

    /// Its radiance is `unchanged` + `albedo` / pi x (irradiance with the scene).
    struct Share {
        glm::vec3 unchanged{0.f}, albedo{0.f}; ///< albedo is above 1 where the image is brighter than what lights it
    };
    /// `seen`: what the image shows there.
    Share share(const glm::vec3& point, const glm::vec3& seen) const;

    const GroundLook& look() const { return look_; }

  private:
    const GroundLook& look_;
    /// Upwards, from what is in the image: lights that were added are not. 0: the ground shines by itself.
    glm::vec3 open_irradiance_{0.f};
};

} // namespace kokage

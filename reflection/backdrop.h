#pragma once
// What is seen where nothing is hit: the environment's remainder, enlarged smoothly, and its lights put back.
#include "common/environment/environment.h"
#include "common/types.h"

#include <vector>

namespace kokage {

class Backdrop {
  public:
    /// The environment must outlive it.
    explicit Backdrop(const Environment& environment);

    /// Radiance without the split-off lights. Under a sky with no lower half, directions below the horizon see the
    /// horizon.
    glm::vec3 remainder(const glm::vec3& direction) const;
    /// Radiance of the split-off lights as a camera sees them: bright regions at the pixels that they were cut from,
    /// discs of suns. Lights without a size can't be seen.
    glm::vec3 lights(const glm::vec3& direction) const;
    glm::vec3 seen(const glm::vec3& direction) const { return remainder(direction) + lights(direction); }

  private:
    struct Disc {
        glm::vec3 direction;
        float squared_chord; ///< of a direction on its rim: a cosine in float is too coarse for small discs
        glm::vec3 radiance;
    };
    const Environment& environment_;
    Image regions_; ///< bright regions, in the remainder's resolution; empty if there are none
    std::vector<Disc> discs_;
};

} // namespace kokage

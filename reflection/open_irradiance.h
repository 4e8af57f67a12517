#pragma once
// How much light a turned surface gets under an open sky: what relief's slopes do to light that was solved for the
// mesh. Private to reflection.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"

namespace kokage {

class OpenIrradiance {
  public:
    /// From the environment's remainder; where that has no lower half, from `ground`, which the sky and all distant
    /// lights light.
    OpenIrradiance(const Environment& environment, const std::optional<Ground>& ground);

    glm::vec3 at(const glm::vec3& normal) const;

  private:
    Image irradiance_; ///< lat-long, by normal
};

} // namespace kokage

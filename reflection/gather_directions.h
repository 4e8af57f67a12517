#pragma once
// Directions in which light is gathered for a diffuse surface: of its cosine lobes, and towards the bright parts of the
// sky, by one-sample multiple importance sampling (Veach 1997, 9.2.4). Private to reflection.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"
#include "common/trace/remainder_sampler.h"

#include <memory>

namespace kokage {

class GatherDirections {
  public:
    /// `above_ground`: a ground hides the remainder's lower half.
    GatherDirections(const Environment& environment, bool above_ground);

    struct Drawn {
        glm::vec3 direction{0, 1, 0};
        glm::vec3 weight{0.f}; ///< times the radiance from there: radiance that the surface sends out, in the mean
    };
    /// `normal`: unit, on the side that is seen. The numbers are uniform in [0, 1).
    Drawn draw(const glm::vec3& normal, const Optics& optics, const glm::vec2& numbers, float choice) const;

  private:
    Image seen_;                            ///< of the remainder, no finer than the sampler is
    std::unique_ptr<RemainderSampler> sky_; ///< null: cosine lobes alone
    float sky_share_ = 0;
};

} // namespace kokage

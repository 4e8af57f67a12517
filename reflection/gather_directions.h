#pragma once
// Directions in which light is gathered for a diffuse surface: of its cosine lobes, whose rays tell of surfaces and of
// the sky, and towards the bright parts of the sky, whose rays need only tell whether it is seen. All tell of the sky
// together, by multiple importance sampling (Veach 1997, 9.2.2). Private to reflection.
#include "common/environment/environment.h"
#include "common/scene/patch_scene.h"
#include "common/trace/remainder_sampler.h"

#include <memory>

namespace kokage {

class GatherDirections {
  public:
    /// To the sky, for each one of the lobes.
    static constexpr int kSkyRays = 1;

    /// `above_ground`: a ground hides the remainder's lower half.
    GatherDirections(const Environment& environment, bool above_ground);

    /// Cosine lobes of both sides of a surface, by luminance.
    class Lobes {
      public:
        /// `normal`: unit, on the side that is seen.
        Lobes(const glm::vec3& normal, const Optics& optics);

      private:
        friend GatherDirections;
        glm::vec3 direction(const glm::vec2& numbers) const;
        float density(float cosine) const;

        const glm::vec3& normal_;
        const Optics& optics_;
        float reflected_share_ = 0;
        bool is_black_ = false;
    };
    /// Weights times the radiance from there, of one ray of the lobes and kSkyRays to the sky, add up in the mean to
    /// the radiance that the surface sends out.
    struct Drawn {
        glm::vec3 direction{0, 1, 0};
        glm::vec3 surface_weight{0.f}; ///< of what a ray of the lobes meets; other rays tell nothing of surfaces
        glm::vec3 sky_weight{0.f};     ///< of the remainder where either kind meets nothing
    };
    /// The numbers are uniform in [0, 1).
    Drawn of_lobes(const Lobes& lobes, const glm::vec2& numbers) const;
    Drawn to_sky(const Lobes& lobes, const glm::vec2& numbers, float choice) const;

  private:
    Drawn drawn(const Lobes& lobes, const glm::vec3& direction) const;

    Image seen_;                            ///< of the remainder, no finer than the sampler is
    std::unique_ptr<RemainderSampler> sky_; ///< null: cosine lobes alone
};

} // namespace kokage

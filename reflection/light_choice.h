#pragma once
// Which lights to test at a point that is shaded: all of them when they are few, else some by what they would
// contribute.
#include "common/environment/cone.h"
#include "common/environment/environment.h"
#include "common/types.h"

#include <vector>

namespace kokage {

/// What a point scatters towards the viewer per unit of irradiance on a facing surface, as a function of the direction
/// to the light. For a two-sided Lambertian side: cos/π times reflectance (light on the viewed side) or transmittance
/// (light from behind).
struct Scattering {
    glm::vec3 normal; ///< unit, on the viewed side
    glm::vec3 reflectance, transmittance;
    /// Gloss (gloss.h), K towards the viewer; 0: matt.
    glm::vec3 gloss{0.f}, mirrored{0.f};
    float roughness = 1;
    bool mirrors_wide_lights = false; ///< else rays of the lobe find those (glossy_light.h)

    glm::vec3 towards(const glm::vec3& direction_to_light) const {
        const float cosine = glm::dot(normal, direction_to_light);
        return (cosine > 0 ? reflectance * cosine : transmittance * -cosine) / kPi;
    }
    bool is_glossy() const { return gloss.r > 0 || gloss.g > 0 || gloss.b > 0; }
    /// The same of the gloss: K times the lobe's value, above the horizon.
    glm::vec3 mirrored_towards(const glm::vec3& direction_to_light) const;
};

/// One shadow ray to trace, and what arrives if it is free.
struct ShadowRay {
    glm::vec3 direction;
    float distance;     ///< infinite for distant lights
    glm::vec3 radiance; ///< scattered to the viewer if nothing is in between; divided by the probability of the choice
    glm::vec3 reflection{0.f}; ///< the same of the gloss; 0 for lights that rays of its lobe find
};

/// Where in a pixel's set of samples we are, for stratification across the set.
struct SampleIndex {
    std::uint32_t index = 0, count = 1; ///< camera rays of the pixel
    std::uint32_t pattern = 0;          ///< of the pixel
};

class LightChoice {
  public:
    LightChoice(const Environment& environment, int light_samples);

    /// Writes the rays to trace into `rays` (cleared first): one or more for each of at most six lights, or two to four
    /// x light_samples chosen by systematic sampling of the lights' unshadowed contributions, so that strong lights are
    /// never missed and weak ones share. `scratch` is working space of the caller.
    void rays_at(const glm::vec3& point, const Scattering& scattering, SampleIndex sample, std::vector<ShadowRay>& rays,
                 std::vector<float>& scratch) const;

  private:
    /// A distant light, ready to be drawn from.
    struct Distant {
        /// Its texels in the order of a curve that fills the sky, so that stratified numbers choose texels that lie
        /// apart.
        DistantLight light;
        Cone cone;                 ///< of a disc
        glm::vec3 disc_irradiance; ///< over the density of the cone's directions
        float sine_of_half_angle;
        std::uint32_t
            rays; ///< shadow rays where all lights are tested: more for wide lights, as their penumbras are wide
        std::vector<double> shares; ///< cumulative share of the luminance, last = 1; empty for a disc
    };
    static Distant prepare(const DistantLight& light, std::uint32_t rays);
    static LightSample draw(const Distant& light, glm::vec2 u);
    float contribution(std::size_t light, const glm::vec3& point, const Scattering& scattering) const;
    void add_ray(std::size_t light, const glm::vec3& point, const Scattering& scattering, float weight, glm::vec2 u,
                 std::vector<ShadowRay>& rays) const;

    std::vector<Distant> distant_;
    std::vector<PointLight> points_;
    std::uint32_t light_samples_, picks_;
};

} // namespace kokage

#pragma once
// The radiance of the ground under a scene, where a camera ray meets it.
#include "reflection/ground_sky_light.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

class GroundShading {
  public:
    /// All must outlive it.
    GroundShading(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                  const Backdrop& backdrop, const LightChoice& lights, const Camera& camera,
                  const PictureOptions& options, Progress& progress);

    /// False if the picture has no ground.
    bool exists() const { return height_.has_value(); }
    /// Distance at which a ray meets the ground; infinite if it doesn't.
    float distance(const glm::vec3& origin, const glm::vec3& direction) const;
    /// Radiance of the ground at that distance, towards the ray's origin. Black from below.
    glm::vec3 radiance(const glm::vec3& origin, const glm::vec3& direction, float distance, SampleIndex sample,
                       ShadingScratch& scratch) const;

  private:
    glm::vec3 diffuse_plane(const glm::vec3& point, const glm::vec3& direction, float distance, SampleIndex sample,
                            ShadingScratch& scratch) const;
    glm::vec3 shadowed_backdrop(const glm::vec3& point, const glm::vec3& direction, SampleIndex sample,
                                ShadingScratch& scratch) const;
    void measure_haze();
    glm::vec3 haze(const glm::vec3& direction) const;
    glm::vec3 light_at(const glm::vec3& point, const glm::vec3& albedo, SampleIndex sample,
                       ShadingScratch& scratch) const;

    const RayQueries& queries_;
    const Backdrop& backdrop_;
    const LightChoice& lights_;
    std::optional<float> height_;
    std::optional<glm::vec3> albedo_; ///< empty: the backdrop is the ground, and takes shadows
    std::optional<GroundSkyLight> light_;
    glm::vec3 backdrop_irradiance_{0.f}; ///< upwards, open: what lit the ground that the backdrop shows
    glm::vec2 centre_{0.f};
    std::vector<glm::vec3> haze_; ///< by azimuth: what far ground fades into
    float scene_radius_ = 1, haze_distance_ = 1, pixel_angle_ = 0.001f;
};

/// Factors on the albedo that vary over the ground as soil and short grass do: brightness at all scales from `size`
/// down to `finest`, and, more slowly, from reddish to greenish. Every channel has mean 1 and stays within 1 +- spread.
glm::vec3 ground_variation(glm::vec2 place, float size, float finest, float spread);

} // namespace kokage

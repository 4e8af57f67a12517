#pragma once
// The ground under a scene as a surface: where it lies, its colour, the air in front of it. Its light is
// ground_shading.h's.
#include "common/trace/ground_plane.h"
#include "reflection/backdrop.h"
#include "reflection/picture.h"

#include <optional>

namespace kokage {

class GroundLook {
  public:
    /// `queries`: of the scene.
    GroundLook(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
               const Backdrop& backdrop, const Camera& camera, const PictureOptions& options);

    /// Empty if the picture has no ground.
    std::optional<float> height() const { return plane_ ? std::optional(plane_->height_m()) : std::nullopt; }
    /// The backdrop plays the ground, which takes shadows.
    bool is_backdrop() const { return plane_ && !albedo_; }
    /// Empty if there is no ground, or the backdrop plays it.
    const std::optional<glm::vec3>& mean_albedo() const { return albedo_; }
    /// Distance at which a ray meets the ground; infinite if it doesn't.
    float distance(const glm::vec3& origin, const glm::vec3& direction) const;
    /// A ray that meets the ground at `ground_distance` shows surfaces up to here in its place: those that lie in the
    /// ground's plane as well. Infinite if it doesn't meet it.
    float distance_to_surfaces(float ground_distance, const glm::vec3& direction) const;
    glm::vec3 point(const glm::vec3& origin, const glm::vec3& direction, float distance) const {
        return {origin.x + distance * direction.x, plane_->height_m(), origin.z + distance * direction.z};
    }
    /// Soil varies. As a camera ray of that length sees it: no finer than a pixel.
    glm::vec3 albedo(const glm::vec3& point, const glm::vec3& direction, float distance) const;
    /// The share of its light that reaches the camera through the air; the rest is haze.
    float clear(float distance) const;
    glm::vec3 haze(const glm::vec3& direction) const;
    /// How far from the scene's middle, in the scene's radii.
    float away(const glm::vec3& point) const;

  private:
    void measure_haze(const Backdrop& backdrop);

    std::optional<GroundPlane> plane_;
    std::optional<glm::vec3> albedo_;
    glm::vec2 centre_{0.f};
    std::vector<glm::vec3> haze_; ///< by azimuth: what far ground fades into
    float scene_radius_ = 1, haze_distance_ = 1, pixel_angle_ = 0.001f;
};

/// Factors on the albedo that vary over the ground as soil and short grass do: brightness at all scales from `size`
/// down to `finest`, and, more slowly, from reddish to greenish. Every channel has mean 1 and stays within 1 +- spread.
glm::vec3 ground_variation(glm::vec2 place, float size, float finest, float spread);

} // namespace kokage

#pragma once
// A picture's rays: where they start and where they go. Private to reflection.
#include "reflection/light_choice.h"
#include "reflection/picture.h"

namespace kokage {

/// Rays through the picture plane at unit distance.
struct CameraFrame {
    glm::vec3 position, forward, right, up; ///< right and up scaled to half the picture plane
    int width, height;

    glm::vec3 direction(float x, float y) const {
        return glm::normalize(forward + (2 * x / float(width) - 1) * right + (1 - 2 * y / float(height)) * up);
    }
};
/// Throws InputError for a camera that looks nowhere.
CameraFrame camera_frame(const Camera& camera, int width, int height);

/// Throws InputError for sizes and counts that can't be.
void check_picture_options(const PictureOptions& options);

/// Rays of one pixel, drawn by the pixel filter.
class PixelRays {
  public:
    PixelRays(const CameraFrame& frame, const PictureOptions& options, int x, int y);

    glm::vec3 direction(std::uint32_t sample) const;
    std::uint64_t pixel() const { return pixel_; } ///< y width + x
    /// For what is stratified over the pixel's samples.
    SampleIndex index(std::uint32_t sample) const { return {sample, samples_, light_pattern_}; }

  private:
    const CameraFrame& frame_;
    float x_, y_;
    std::uint64_t pixel_;
    std::uint32_t samples_, film_pattern_, light_pattern_;
};

/// What overflowed on the way is as bright as a picture can hold; never NaN. (A single ray's share of a pixel may be
/// negative, gloss_shading.h.)
glm::dvec3 displayable(const glm::vec3& radiance);

} // namespace kokage

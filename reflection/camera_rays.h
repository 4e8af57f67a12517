#pragma once
// A picture's rays: where they start and where they go. Private to reflection.
#include "common/trace/path_numbers.h"
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

/// Rays of one square of the picture, spread evenly over it. Any number of them in a row, from any on, is.
class SquareRays {
  public:
    /// x, y may lie outside of the picture.
    SquareRays(const CameraFrame& frame, const PictureOptions& options, int x, int y);

    /// From the square's upper left corner.
    glm::vec2 place(std::uint32_t sample) const { return places_.at(sample); }
    glm::vec3 direction(const glm::vec2& place) const { return frame_.direction(x_ + place.x, y_ + place.y); }
    /// For what is stratified over the rays from `begin` to `end`.
    SampleIndex index(std::uint32_t sample, std::uint32_t begin, std::uint32_t end) const {
        return {sample - begin, end - begin, light_pattern_ ^ begin * 0x9e3779b9u};
    }

  private:
    SquareRays(const CameraFrame& frame, std::uint64_t seed, int x, int y, std::uint64_t square);

    const CameraFrame& frame_;
    float x_, y_;
    SobolPairs places_;
    std::uint32_t light_pattern_;
};

/// What overflowed on the way is as bright as a picture can hold; never NaN. (A single ray's share of a pixel may be
/// negative, gloss_shading.h.)
glm::dvec3 displayable(const glm::vec3& radiance);

} // namespace kokage

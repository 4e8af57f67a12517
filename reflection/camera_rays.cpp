#include "reflection/camera_rays.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {
namespace {

constexpr double kLargestRadiance = 1e35;

std::uint32_t pattern_of(std::uint64_t seed, std::uint64_t pixel, std::uint64_t purpose) {
    return std::uint32_t(hash64(hash64(seed ^ hash64(purpose)) + pixel) >> 32);
}

} // namespace

CameraFrame camera_frame(const Camera& camera, int width, int height) {
    const float angle = camera.vertical_field_of_view;
    if (!(angle > 0 && angle < kPi))
        throw InputError("camera: field of view " + std::to_string(angle) + " rad; it must lie between 0 and π");
    const glm::dvec3 towards = glm::dvec3(camera.target) - glm::dvec3(camera.position);
    if (!(glm::length(towards) > 0) || !std::isfinite(glm::length(towards)))
        throw InputError("camera: position and target must be finite and differ");
    const glm::dvec3 forward = glm::normalize(towards);
    glm::dvec3 side = glm::cross(forward, glm::dvec3(camera.up));
    if (!(glm::length(side) > 1e-9)) // looking along `up`: any horizontal edge will do
        side = glm::cross(forward, std::abs(forward.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1));
    side = glm::normalize(side);
    const double half_height = std::tan(0.5 * double(angle)), half_width = half_height * width / height;
    return {camera.position, forward, half_width * side, half_height * glm::cross(side, forward), width, height};
}

void check_picture_options(const PictureOptions& options) {
    if (options.width < 1 || options.height < 1 || double(options.width) * options.height > 1e9)
        throw InputError("picture: " + std::to_string(options.width) + " x " + std::to_string(options.height) +
                         " pixels; give 1 to 1e9 in all");
    if (const int rays = gather_rays_of(options); rays < 0 || rays > 1024)
        throw InputError("picture: " + std::to_string(rays) + " gathering rays; give 0 to 1024");
    if (options.samples < 1 || options.samples > (1 << 16) || options.light_samples < 1 ||
        options.light_samples > (1 << 12))
        throw InputError("picture: " + std::to_string(options.samples) + " samples and " +
                         std::to_string(options.light_samples) + " light samples; give 1 to 65536 and 1 to 4096");
}

PixelRays::PixelRays(const CameraFrame& frame, const PictureOptions& options, int x, int y)
    : frame_(frame), x_(float(x)), y_(float(y)),
      pixel_(std::uint64_t(y) * std::uint64_t(options.width) + std::uint64_t(x)),
      samples_(std::uint32_t(options.samples)), film_pattern_(pattern_of(options.seed, pixel_, 1)),
      light_pattern_(pattern_of(options.seed, pixel_, 2)) {}

glm::vec3 PixelRays::direction(std::uint32_t sample) const {
    const glm::vec2 u = multi_jittered(sample, samples_, film_pattern_);
    return frame_.direction(x_ + 0.5f + pixel_filter_offset(u.x), y_ + 0.5f + pixel_filter_offset(u.y));
}

SquareRays::SquareRays(const CameraFrame& frame, const PictureOptions& options, int x, int y)
    : SquareRays(frame, options.seed, x, y,
                 std::uint64_t(y + 1) * std::uint64_t(options.width + 2) + std::uint64_t(x + 1)) {}

SquareRays::SquareRays(const CameraFrame& frame, std::uint64_t seed, int x, int y, std::uint64_t square)
    : frame_(frame), x_(float(x)), y_(float(y)), places_(hash64(hash64(seed ^ hash64(3)) + square)),
      light_pattern_(pattern_of(seed, square, 4)) {}

glm::dvec3 displayable(const glm::vec3& radiance) {
    glm::dvec3 result(0.);
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = std::isnan(radiance[c]) ? kLargestRadiance
                                            : std::clamp(double(radiance[c]), -kLargestRadiance, kLargestRadiance);
    return result;
}

} // namespace kokage

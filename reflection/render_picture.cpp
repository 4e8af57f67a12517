#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/backdrop.h"
#include "reflection/ground_shading.h"
#include "reflection/picture.h"
#include "reflection/sampling.h"
#include "reflection/surface_shading.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr double kLargestRadiance = 1e35;

/// Rays through the picture plane at unit distance.
struct CameraFrame {
    glm::vec3 position, forward, right, up; ///< right and up scaled to half the picture plane
    int width, height;

    glm::vec3 direction(float x, float y) const {
        return glm::normalize(forward + (2 * x / float(width) - 1) * right + (1 - 2 * y / float(height)) * up);
    }
};

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

void check(const PictureOptions& options) {
    if (options.width < 1 || options.height < 1 || double(options.width) * options.height > 1e9)
        throw InputError("picture: " + std::to_string(options.width) + " x " + std::to_string(options.height) +
                         " pixels; give 1 to 1e9 in all");
    if (options.samples < 1 || options.samples > (1 << 16) || options.light_samples < 1 ||
        options.light_samples > (1 << 12))
        throw InputError("picture: " + std::to_string(options.samples) + " samples and " +
                         std::to_string(options.light_samples) + " light samples; give 1 to 65536 and 1 to 4096");
}

/// Everything that a ray needs to become a colour.
struct Renderer {
    const RayQueries& queries;
    const Backdrop& backdrop;
    const SurfaceShading& surfaces;
    const GroundShading& ground;

    /// `met` counts rays that met a surface.
    glm::vec3 radiance(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample, ShadingScratch& scratch,
                       std::uint32_t& met) const {
        RayHit hit;
        const float ground_distance = ground.distance(origin, direction);
        const bool found = queries.first_hit(origin, direction, 0.f, kInfinity, hit) && !hit.ground;
        if (found && hit.distance <= ground_distance) {
            ++met;
            return surfaces.radiance(origin, direction, hit, sample, scratch);
        }
        if (ground_distance < kInfinity)
            return ground.radiance(origin, direction, ground_distance, sample, scratch);
        return backdrop.seen(direction);
    }
};

std::uint32_t pattern_of(std::uint64_t seed, std::uint64_t pixel, std::uint64_t purpose) {
    return std::uint32_t(hash64(hash64(seed ^ hash64(purpose)) + pixel) >> 32);
}

} // namespace

Image render_picture(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                     const Camera& camera, const PictureOptions& options, Progress& progress, Image* subject) {
    check(options);
    if (!scene.patches)
        throw InputError("picture: there is no scene of patches");
    if (environment.remainder.empty() || environment.remainder.channels < 3)
        throw InputError("picture: the environment has no image of 3 channels");
    const CameraFrame frame = camera_frame(camera, options.width, options.height);
    const Backdrop backdrop(environment);
    const LightChoice lights(environment, options.light_samples);
    const SurfaceShading surfaces(scene, queries, lights, options.pixel_shadows);
    const GroundShading ground(scene, queries, environment, backdrop, lights, camera, options, progress);
    const Renderer renderer{queries, backdrop, surfaces, ground};

    Image picture(options.width, options.height, 3);
    if (subject)
        *subject = Image(options.width, options.height, 1);
    const auto samples = std::uint32_t(options.samples);
    progress.begin("rendering the picture", std::size_t(options.height));
    parallel_blocks(std::size_t(options.height), 2, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        ShadingScratch scratch;
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < options.width; ++x) {
                const auto pixel = std::uint64_t(y) * std::uint64_t(options.width) + std::uint64_t(x);
                const std::uint32_t film_pattern = pattern_of(options.seed, pixel, 1);
                const std::uint32_t light_pattern = pattern_of(options.seed, pixel, 2);
                glm::dvec3 sum(0.0);
                std::uint32_t met = 0;
                for (std::uint32_t s = 0; s < samples; ++s) {
                    const glm::vec2 u = multi_jittered(s, samples, film_pattern);
                    const glm::vec3 direction = frame.direction(float(x) + 0.5f + pixel_filter_offset(u.x),
                                                                float(y) + 0.5f + pixel_filter_offset(u.y));
                    const glm::dvec3 seen =
                        renderer.radiance(frame.position, direction, {s, samples, light_pattern}, scratch, met);
                    for (std::size_t c = 0; c < 3; ++c) // what overflowed on the way is as bright as a picture can hold
                        sum[c] += seen[c] < kLargestRadiance ? std::max(seen[c], 0.0) : kLargestRadiance;
                }
                for (int c = 0; c < 3; ++c)
                    picture.at(x, y)[c] = float(sum[std::size_t(c)] / samples);
                if (subject)
                    subject->at(x, y)[0] = float(met) / float(samples);
            }
        progress.advance(end - begin);
    });
    return picture;
}

} // namespace kokage

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/backdrop.h"
#include "reflection/camera_rays.h"
#include "reflection/gloss_shading.h"
#include "reflection/picture.h"
#include "reflection/surface_shading.h"

#include <algorithm>
#include <limits>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Everything that a ray needs to become a colour.
struct Renderer {
    const RayQueries& queries;
    const Backdrop& backdrop;
    const SurfaceShading& surfaces;
    const GroundLook& ground;
    const GroundShading& ground_light;
    const GlossShading& gloss;

    /// `met` counts rays that met a surface.
    glm::vec3 radiance(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample, ShadingScratch& scratch,
                       std::uint32_t& met) const {
        RayHit hit;
        const float ground_distance = ground.distance(origin, direction);
        const bool found = queries.first_hit(origin, direction, 0.f, kInfinity, hit) && !hit.ground;
        if (found && hit.distance <= ground_distance) {
            ++met;
            const SurfacePoint at = surfaces.point(origin, direction, hit);
            return surfaces.radiance(at, direction, sample, scratch).total() +
                   gloss.radiance(at, direction, sample, scratch);
        }
        if (ground_distance < kInfinity)
            return ground_light.radiance(origin, direction, ground_distance, sample, scratch);
        return backdrop.seen(direction);
    }
};

} // namespace

Picture render_picture(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                       const Camera& camera, const PictureOptions& options, Progress& progress) {
    check_picture_options(options);
    if (!scene.patches)
        throw InputError("picture: there is no scene of patches");
    if (environment.remainder.empty() || environment.remainder.channels < 3)
        throw InputError("picture: the environment has no image of 3 channels");
    const CameraFrame frame = camera_frame(camera, options.width, options.height);
    const Backdrop backdrop(environment);
    const LightChoice lights(environment, options.light_samples);
    const SurfaceShading surfaces(scene, queries, lights, options.pixel_shadows);
    const GroundLook ground(scene, environment, backdrop, camera, options);
    Picture picture;
    const GroundShading ground_light(scene, queries, environment, backdrop, ground, lights, progress);
    const GlossShading gloss(scene, queries, environment, surfaces, ground, ground_light, progress, picture.report);
    const Renderer renderer{queries, backdrop, surfaces, ground, ground_light, gloss};

    picture.radiance = Image(options.width, options.height, 3);
    picture.subject = Image(options.width, options.height, 1);
    const auto samples = std::uint32_t(options.samples);
    progress.begin("rendering the picture", std::size_t(options.height));
    parallel_blocks(std::size_t(options.height), 2, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        ShadingScratch scratch;
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < options.width; ++x) {
                const PixelRays rays(frame, options, x, y);
                glm::dvec3 sum(0.0);
                std::uint32_t met = 0;
                for (std::uint32_t s = 0; s < samples; ++s)
                    sum +=
                        displayable(renderer.radiance(frame.position, rays.direction(s), rays.index(s), scratch, met));
                for (int c = 0; c < 3; ++c)
                    picture.radiance.at(x, y)[c] = float(std::max(sum[std::size_t(c)], 0.) / samples);
                picture.subject.at(x, y)[0] = float(met) / float(samples);
            }
        progress.advance(end - begin);
    });
    return picture;
}

} // namespace kokage

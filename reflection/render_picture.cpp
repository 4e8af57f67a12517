#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/backdrop.h"
#include "reflection/camera_rays.h"
#include "reflection/gloss_shading.h"
#include "reflection/picture.h"
#include "reflection/seen_by_ray.h"
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

    SeenByRay seen(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample,
                   ShadingScratch& scratch) const {
        RayHit hit;
        const float ground_distance = ground.distance(origin, direction);
        const bool found = queries.first_hit(origin, direction, 0.f, kInfinity, hit) && !hit.ground;
        if (found && hit.distance <= ground_distance) {
            const SurfacePoint at = surfaces.point(origin, direction, hit);
            SeenByRay seen = SeenByRay::surface_at(at, hit.distance, queries.scene());
            SurfaceRadiance light = surfaces.radiance(at, direction, sample, scratch);
            light.reflection += gloss.radiance(at, direction, sample, scratch);
            seen.radiance = light.total();
            seen.direct = light.direct;
            seen.indirect = light.indirect;
            seen.reflection = light.reflection;
            return seen;
        }
        if (!(ground_distance < kInfinity))
            return SeenByRay::surroundings(backdrop.seen(direction));
        const GroundRadiance light = ground_light.radiance(origin, direction, ground_distance, sample, scratch);
        SeenByRay seen = SeenByRay::ground_at(light.albedo, ground_distance);
        seen.radiance = light.total;
        seen.direct = light.direct;
        seen.indirect = light.total - light.direct;
        return seen;
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
    Picture picture = empty_picture(options);
    const GroundShading ground_light(scene, queries, environment, backdrop, ground, lights, progress);
    const GlossShading gloss(scene, queries, environment, surfaces, ground, ground_light, progress, picture.report);
    const Renderer renderer{queries, backdrop, surfaces, ground, ground_light, gloss};

    const auto samples = std::uint32_t(options.samples);
    progress.begin("rendering the picture", std::size_t(options.height));
    parallel_blocks(std::size_t(options.height), 2, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        ShadingScratch scratch;
        PixelSum sum(frame, options.layers);
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < options.width; ++x) {
                const PixelRays rays(frame, options, x, y);
                sum.clear();
                for (std::uint32_t s = 0; s < samples; ++s) {
                    const glm::vec3 direction = rays.direction(s);
                    sum.add(renderer.seen(frame.position, direction, rays.index(s), scratch), direction);
                }
                sum.store(picture, x, y);
            }
        progress.advance(end - begin);
    });
    return picture;
}

} // namespace kokage

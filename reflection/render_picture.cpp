#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/backdrop.h"
#include "reflection/camera_rays.h"
#include "reflection/gloss_shading.h"
#include "reflection/picture.h"
#include "reflection/relief_surfaces.h"
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

    SeenByRay seen(const glm::vec3& origin, const CameraHit& hit, SampleIndex sample, ShadingScratch& scratch) const {
        const glm::vec3 direction = hit.direction;
        const float ground_distance = ground.distance(origin, direction);
        if (hit.found && !hit.hit.ground && hit.hit.distance <= ground_distance) {
            const SurfacePoint at = surfaces.point(origin, hit);
            SeenByRay seen = SeenByRay::surface_at(at, hit.hit.distance, queries.scene());
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
    const ReliefSurfaces relief(scene, queries, frame, progress, picture.report);
    const Renderer renderer{queries, backdrop, surfaces, ground, ground_light, gloss};

    const auto samples = std::uint32_t(options.samples);
    progress.begin("rendering the picture", std::size_t(options.height));
    parallel_blocks(std::size_t(options.height), 2, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        ShadingScratch scratch;
        PixelSum sum(frame, options.layers);
        for (int y = int(begin); y < int(end); ++y) {
            RowHits hits(relief, frame, options, y);
            for (int x = 0; x < options.width; ++x) {
                const PixelRays rays(frame, options, x, y);
                sum.clear();
                const std::span<const CameraHit> of_pixel = hits.of_pixel(x);
                for (std::uint32_t s = 0; s < samples; ++s)
                    sum.add(renderer.seen(frame.position, of_pixel[s], rays.index(s), scratch), of_pixel[s].direction);
                sum.store(picture, x, y);
            }
        }
        progress.advance(end - begin);
    });
    return picture;
}

} // namespace kokage

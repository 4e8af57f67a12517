#include "reflection/path_traced_picture.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/camera_rays.h"
#include "reflection/ground_look.h"
#include "reflection/path_integrator.h"
#include "reflection/relief_surfaces.h"
#include "reflection/seen_by_ray.h"

#include <algorithm>
#include <limits>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct TruthOfPicture {
    const RayQueries& queries;
    const Backdrop& backdrop;
    const GroundLook& ground;
    const PathIntegrator& paths;

    SeenByRay seen(const glm::vec3& origin, const CameraHit& hit, PathNumbers& numbers) const {
        const glm::vec3 direction = hit.direction;
        const float ground_distance = ground.distance(origin, direction);
        if (hit.shows_surface(ground.distance_to_surfaces(ground_distance, direction))) {
            const SurfacePoint at = paths.points().at(origin, hit);
            return SeenByRay::surface_at(at, hit.hit.distance, queries.scene(),
                                         paths.radiance(PathIntegrator::surface_vertex(at, direction), numbers));
        }
        if (!(ground_distance < kInfinity))
            return SeenByRay::surroundings(backdrop.seen(direction));
        if (direction.y >= 0)
            return SeenByRay::ground_at(glm::vec3(0.f), ground_distance, {});
        const glm::vec3 point = ground.point(origin, direction, ground_distance);
        const float clear = ground.clear(ground_distance);
        const glm::vec3 albedo = ground.albedo(point, direction, ground_distance);
        SurfaceRadiance light = paths.radiance(PathIntegrator::ground_vertex(point, albedo), numbers);
        light.direct *= clear;
        light.indirect = clear * light.indirect + (1 - clear) * ground.haze(direction);
        return SeenByRay::ground_at(albedo, ground_distance, light);
    }
};

/// A backdrop that plays the ground: how bright it would be without the scene is seen, how it is lit is not.
bool leaves_ground_out(const ShadedScene& scene, const Environment& environment, const PictureOptions& options) {
    return environment.has_lower_half && options.ground == PictureGround::automatic && !scene.patches->ground &&
           !scene.patches->triangles.empty();
}

} // namespace

Picture render_path_traced(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                           const Camera& camera, const PictureOptions& options, Progress& progress) {
    check_picture_options(options);
    if (!scene.patches)
        throw InputError("picture: there is no scene of patches");
    PictureOptions with_true_ground = options;
    if (environment.has_lower_half)
        with_true_ground.ground = PictureGround::none;
    const CameraFrame frame = camera_frame(camera, options.width, options.height);
    const Backdrop backdrop(environment);
    const GroundLook ground(scene, queries, environment, backdrop, camera, with_true_ground);
    const PathIntegrator paths(scene, queries, environment);
    const TruthOfPicture truth{queries, backdrop, ground, paths};

    Picture picture = empty_picture(options);
    if (leaves_ground_out(scene, environment, options))
        picture.report.skips.push_back({"the scene's shade on the surroundings' lower half",
                                        "what lights the ground that an image shows is not known, so there is no "
                                        "truth; compare with fast pictures "
                                        "without a ground, or give both a ground",
                                        ""});
    const ReliefSurfaces relief(scene, queries, environment, frame, options.skips.thin_relief, progress,
                                picture.report);
    const auto samples = std::uint32_t(options.samples);
    progress.begin("tracing paths", std::size_t(options.height));
    parallel_blocks(std::size_t(options.height), 1, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        PixelSum sum(frame, options.layers);
        for (int y = int(begin); y < int(end); ++y) {
            if (y % std::max(options.every_row, 1) != 0)
                continue;
            RowHits hits(relief, frame, options, y);
            for (int x = 0; x < options.width; ++x) {
                if (!is_traced(options, x, y))
                    continue;
                const PixelRays rays(frame, options, x, y);
                const std::uint64_t seed = hash64(options.seed ^ hash64(rays.pixel()));
                sum.clear();
                const std::span<const CameraHit> of_pixel = hits.of_pixel(x);
                for (std::uint32_t s = 0; s < samples; ++s) {
                    PathNumbers numbers(seed, s);
                    sum.add(truth.seen(frame.position, of_pixel[s], numbers), of_pixel[s].direction);
                }
                sum.store(picture, x, y);
            }
        }
        progress.advance(end - begin);
    });
    return picture;
}

} // namespace kokage

#include "reflection/path_traced_picture.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/backdrop_ground.h"
#include "reflection/camera_rays.h"
#include "reflection/path_integrator.h"
#include "reflection/relief_surfaces.h"
#include "reflection/seen_by_ray.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct TruthOfPicture {
    const RayQueries& queries;
    const Backdrop& backdrop;
    const GroundLook& ground;
    const BackdropGround* backdrop_ground; ///< null where the backdrop plays no ground
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
        if (backdrop_ground)
            return SeenByRay::ground_at(glm::vec3(0.f), ground_distance, changed_backdrop(point, direction, numbers));
        const float clear = ground.clear(ground_distance);
        const glm::vec3 albedo = ground.albedo(point, direction, ground_distance);
        SurfaceRadiance light = paths.radiance(PathIntegrator::ground_vertex(point, albedo), numbers);
        light.direct *= clear;
        light.indirect = clear * light.indirect + (1 - clear) * ground.haze(direction);
        return SeenByRay::ground_at(albedo, ground_distance, light);
    }

    SurfaceRadiance changed_backdrop(const glm::vec3& point, const glm::vec3& direction, PathNumbers& numbers) const {
        const BackdropGround::Share share =
            backdrop_ground->share(point, backdrop.remainder(direction), backdrop.lights(direction));
        SurfaceRadiance light;
        if (share.albedo != glm::vec3(0.f)) {
            PathVertex vertex = PathIntegrator::ground_vertex(point, share.albedo);
            vertex.on_backdrop = true;
            light = paths.radiance(vertex, numbers);
        }
        light.indirect += share.unchanged;
        return light;
    }
};

} // namespace

Picture render_path_traced(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                           const Camera& camera, const PictureOptions& options, Progress& progress) {
    check_picture_options(options);
    if (!scene.patches)
        throw InputError("picture: there is no scene of patches");
    const CameraFrame frame = camera_frame(camera, options.width, options.height);
    const Backdrop backdrop(environment);
    const GroundLook ground(scene, queries, environment, backdrop, camera, options);
    std::optional<BackdropGround> backdrop_ground;
    if (ground.is_backdrop())
        backdrop_ground.emplace(environment, backdrop, ground);
    const BackdropGround* changed = backdrop_ground ? &*backdrop_ground : nullptr;
    const PathIntegrator paths(scene, queries, environment, changed);
    const TruthOfPicture truth{queries, backdrop, ground, changed, paths};

    Picture picture = empty_picture(options);
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

#include "reflection/path_traced_picture.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/camera_rays.h"
#include "reflection/ground_look.h"
#include "reflection/path_integrator.h"

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

    /// `met` counts rays that met a surface.
    glm::vec3 radiance(const glm::vec3& origin, const glm::vec3& direction, PathNumbers& numbers,
                       std::uint32_t& met) const {
        RayHit hit;
        const float ground_distance = ground.distance(origin, direction);
        const bool found = queries.first_hit(origin, direction, 0.f, kInfinity, hit) && !hit.ground;
        if (found && hit.distance <= ground_distance) {
            ++met;
            return paths.radiance(paths.surface_vertex(origin, direction, hit), numbers);
        }
        if (!(ground_distance < kInfinity))
            return backdrop.seen(direction);
        if (direction.y >= 0)
            return glm::vec3(0.f);
        const glm::vec3 point = ground.point(origin, direction, ground_distance);
        const float clear = ground.clear(ground_distance);
        const glm::vec3 albedo = ground.albedo(point, direction, ground_distance);
        return clear * paths.radiance(PathIntegrator::ground_vertex(point, albedo), numbers) +
               (1 - clear) * ground.haze(direction);
    }
};

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
    const GroundLook ground(scene, environment, backdrop, camera, with_true_ground);
    const PathIntegrator paths(scene, queries, environment);
    const TruthOfPicture truth{queries, backdrop, ground, paths};

    Picture picture;
    picture.radiance = Image(options.width, options.height, 3);
    picture.subject = Image(options.width, options.height, 1);
    const auto samples = std::uint32_t(options.samples);
    progress.begin("tracing paths", std::size_t(options.height));
    parallel_blocks(std::size_t(options.height), 1, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < options.width; ++x) {
                const PixelRays rays(frame, options, x, y);
                const std::uint64_t seed = hash64(options.seed ^ hash64(rays.pixel()));
                glm::dvec3 sum(0.0);
                std::uint32_t met = 0;
                for (std::uint32_t s = 0; s < samples; ++s) {
                    PathNumbers numbers(seed, s);
                    sum += displayable(truth.radiance(frame.position, rays.direction(s), numbers, met));
                }
                for (int c = 0; c < 3; ++c)
                    picture.radiance.at(x, y)[c] = float(sum[std::size_t(c)] / samples);
                picture.subject.at(x, y)[0] = float(met) / float(samples);
            }
        progress.advance(end - begin);
    });
    return picture;
}

} // namespace kokage

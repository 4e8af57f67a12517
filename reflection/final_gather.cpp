#include "reflection/final_gather.h"
#include "common/environment/lat_long.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "common/trace/path_numbers.h"
#include "reflection/flat_patches.h"
#include "reflection/gather_directions.h"
#include "reflection/gathered_sums.h"
#include "reflection/map_corrections.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr int kRowsAtOnce = 16;
constexpr std::uint64_t kGatherNumbers = 0x67617468, kPlaceNumbers = 0x706c6163;

/// A millionfold sum of such numbers is finite. What is not a number has no part in it.
glm::vec3 summable(const glm::vec3& light) {
    constexpr float kLargest = 1e28f;
    glm::vec3 result(0.f);
    for (std::size_t c = 0; c < 3; ++c)
        if (!std::isnan(light[c]))
            result[c] = std::clamp(light[c], -kLargest, kLargest);
    return result;
}

/// What camera rays of a row see that more is to be known of.
struct SeenRow {
    struct Point {
        CameraHit hit;
        std::uint32_t side;   ///< of a patch
        std::uint32_t number; ///< of the side's rays
    };
    std::vector<Point> points;
};

struct GatheredRow {
    std::vector<GatheredSample> samples;
    std::uint64_t rays = 0, sky_rays = 0;
};

class Gathering {
  public:
    Gathering(const ShadedScene& scene, const ReliefSurfaces& relief, const CameraFrame& frame,
              const PictureOptions& options, const IncomingRadiance& incoming, const Environment& environment,
              const SurfaceShading& surfaces, const GlossShading& gloss)
        : scene_(scene), relief_(relief), frame_(frame), options_(options), incoming_(incoming),
          environment_(environment), surfaces_(surfaces), gloss_(gloss), flat_(flat_patches(*scene.patches)),
          directions_(environment, incoming.has_ground()) {}

    /// By one ray a pixel of some rows from `first` on: what the camera sees and `sums` knows too little of.
    std::vector<SeenRow> seen_rows(int pass, int first, const GatheredSums& sums) const {
        std::vector<SeenRow> rows(static_cast<std::size_t>(std::min(kRowsAtOnce, options_.height - first)));
        parallel_blocks(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t row = begin; row < end; ++row)
                rows[row] = seen_row(pass, first + int(row), sums);
        });
        return rows;
    }

    std::vector<GatheredRow> gathered_rows(const std::vector<SeenRow>& seen, Progress& progress) const {
        std::vector<GatheredRow> rows(seen.size());
        parallel_blocks(rows.size(), 1, [&](std::size_t begin, std::size_t end) {
            progress.throw_if_stopped();
            for (std::size_t row = begin; row < end; ++row)
                rows[row] = gathered_row(seen[row]);
            progress.advance(end - begin);
        });
        return rows;
    }

  private:
    SeenRow seen_row(int pass, int y, const GatheredSums& sums) const {
        std::vector<CameraHit> hits;
        const std::uint64_t seed = hash64(options_.seed ^ hash64(kPlaceNumbers + std::uint64_t(pass)));
        for (int x = 0; x < options_.width; ++x) {
            // Numbers in a row fill squares of the picture.
            const glm::vec2 place = PathNumbers(seed, place_on_curve(std::uint32_t(x), std::uint32_t(y))).pair();
            hits.emplace_back().direction = frame_.direction(float(x) + place.x, float(y) + place.y);
        }
        relief_.first_hits(hits);
        SeenRow row;
        for (const CameraHit& hit : hits)
            if (hit.shows_surface(incoming_.ground_distance(frame_.position, hit.direction)))
                if (const SurfacePoint at = surfaces_.point(frame_.position, hit); !sums.enough(surfaces_.places(at)))
                    row.points.push_back({hit, 2 * at.patch + !at.front, 0});
        return row;
    }

    GatheredRow gathered_row(const SeenRow& seen) const {
        GatheredRow row;
        ShadingScratch scratch;
        for (const SeenRow::Point& point : seen.points) {
            // A side's rays are one sequence, however they are spread over the picture and its passes.
            PathNumbers numbers(hash64(options_.seed ^ hash64(kGatherNumbers + point.side)), point.number);
            row.samples.push_back(from(point.hit, numbers, scratch));
        }
        row.rays = scratch.met_rays;
        row.sky_rays = scratch.sky_rays;
        return row;
    }

    GatheredSample from(const CameraHit& hit, PathNumbers& numbers, ShadingScratch& scratch) const {
        const SurfacePoint at = surfaces_.point(frame_.position, hit);
        const PatchScene& patches = *scene_.patches;
        const Optics& optics = patches.optics[patches.patches[at.patch].optics];
        GatheredSample sample;
        sample.places = surfaces_.places(at);
        sample.point = at.point;
        sample.origin = patches.positions[patches.triangles[patches.patches[at.patch].first_triangle].x];
        sample.is_flat = !at.smooth && flat_[at.patch];
        sample.solved = summable(surfaces_.solved(at));
        sample.look = 2 * (scene_.looks.empty() ? 0 : scene_.triangle_look[at.triangle]) + !at.front;
        const glm::vec2 mirrored = numbers.pair();
        const SampleIndex index{0, 1, std::uint32_t(hash64(numbers.independent() * 4294967296.f))};
        sample.gathered = scattered_light(at, optics, numbers, index, scratch);
        if (flat_[at.patch])
            sample.lobe = gloss_.lobe_of_patch(at);
        if (sample.lobe) {
            sample.lobe_open = summable(gloss_.open_light(at, hit.direction));
            sample.lobe_correction = summable(gloss_.correction(at, hit.direction, mirrored, index, scratch));
        }
        if (gloss_.has_maps(at))
            sample.lobe_of_map = {summable(gloss_.light_of_ray(at, hit.direction, mirrored, index, scratch)),
                                  summable(gloss_.light_of_maps(at, hit.direction))};
        return sample;
    }

    glm::vec3 scattered_light(const SurfacePoint& at, const Optics& optics, PathNumbers& numbers, SampleIndex index,
                              ShadingScratch& scratch) const {
        const glm::vec3 normal = at.relief ? at.relief->mesh_normal : at.normal;
        const GatherDirections::Lobes lobes(normal, optics);
        // Grazing rays would meet the surface that they leave, which is only known to rounding.
        const auto origin = [&](const glm::vec3& direction) {
            return at.point + std::copysign(incoming_.ray_offset(), glm::dot(normal, direction)) * at.geometric_normal;
        };
        glm::vec3 sum(0.f);
        if (const auto drawn = directions_.of_lobes(lobes, numbers.pair()); luminance(drawn.surface_weight) > 0) {
            const auto met = incoming_.along(origin(drawn.direction), drawn.direction, index, scratch);
            sum += met ? drawn.surface_weight * summable(*met) : drawn.sky_weight * sky(drawn.direction);
        }
        for (int k = 0; k < GatherDirections::kSkyRays; ++k) {
            const glm::vec2 place = numbers.pair();
            const auto drawn = directions_.to_sky(lobes, place, numbers.independent());
            const glm::vec3 light = drawn.sky_weight * sky(drawn.direction);
            if (luminance(light) > 0 && incoming_.sees_sky(origin(drawn.direction), drawn.direction, scratch))
                sum += light;
        }
        return summable(sum);
    }

    glm::vec3 sky(const glm::vec3& direction) const {
        return summable(lat_long_radiance(environment_.remainder, direction));
    }

    const ShadedScene& scene_;
    const ReliefSurfaces& relief_;
    const CameraFrame& frame_;
    const PictureOptions& options_;
    const IncomingRadiance& incoming_;
    const Environment& environment_;
    const SurfaceShading& surfaces_;
    const GlossShading& gloss_;
    const std::vector<std::uint8_t> flat_;
    const GatherDirections directions_;
};

} // namespace

void gather_for_camera(const ShadedScene& scene, const ReliefSurfaces& relief, const CameraFrame& frame,
                       const PictureOptions& options, const IncomingRadiance& incoming, const Environment& environment,
                       SurfaceShading& surfaces, GlossShading& gloss, Progress& progress, WorkReport& report) {
    const int rays = gather_rays_of(options);
    if (rays == 0)
        return;
    if (!options.pixel_shadows) {
        report.skips.push_back({"final gathering", "shadows are not tested per pixel",
                                std::to_string(rays) + " rays a pixel; patches keep their mean light"});
        return;
    }
    const Gathering gathering(scene, relief, frame, options, incoming, environment, surfaces, gloss);
    GatheredSums sums(surfaces.light_count(), gloss.lobe_count());
    MapCorrections maps(surfaces.light_count(), std::max<std::size_t>(scene.looks.size(), 1));
    std::vector<std::uint32_t> rays_of_sides(2 * scene.patches->patches.size(), 0);
    progress.begin("gathering light where the camera looks", std::size_t(options.height) * std::size_t(rays));
    std::uint64_t traced = 0, to_sky = 0;
    for (int pass = 0; pass < rays; ++pass) {
        const std::uint64_t before = sums.samples();
        for (int first = 0; first < options.height; first += kRowsAtOnce) {
            std::vector<SeenRow> seen = gathering.seen_rows(pass, first, sums);
            for (SeenRow& row : seen)
                for (SeenRow::Point& point : row.points)
                    point.number = rays_of_sides[point.side]++;
            for (const GatheredRow& row : gathering.gathered_rows(seen, progress)) {
                for (const GatheredSample& sample : row.samples) {
                    sums.add(sample);
                    if (sample.lobe_of_map)
                        maps.add(sample.places, sample.look, *sample.lobe_of_map);
                }
                traced += row.rays;
                to_sky += row.sky_rays;
            }
        }
        sums.end_pass();
        if (sums.samples() == before) {
            report.skips.push_back({"gathering on", "all that is in view has rays enough",
                                    std::to_string(rays - pass) + " of " + std::to_string(rays) + " rays a pixel"});
            break;
        }
    }
    sums.give_light(surfaces, *scene.patches, frame);
    sums.give_lobes(gloss, *scene.patches, frame);
    maps.give(gloss);
    report.counts.push_back({"gathering rays", traced});
    report.counts.push_back({"gathering rays to the sky", to_sky});
}

double gathering_bytes(const PictureOptions& options, double patches, double corners, int threads) {
    const double rays = double(options.width) * double(options.height) * gather_rays_of(options);
    if (rays == 0)
        return 0;
    // Few patches show the camera both of their sides.
    const GatheredSums::Counts counts{patches, corners, std::min(patches, rays), std::min(corners, 3 * rays)};
    const double row = double(options.width), row_of_hits = row * double(sizeof(CameraHit)),
                 row_of_points = row * double(sizeof(SeenRow::Point) + sizeof(GatheredSample)),
                 numbers = 2 * patches * double(sizeof(std::uint32_t));
    constexpr double kGrown = 2; // vectors that are filled without being told how far
    return GatheredSums::most_bytes(counts) + GatheredSums::most_bytes_to_give(counts) +
           MapCorrections::most_bytes(2 * (patches + corners), counts.seen_corners) +
           PatchGradients::most_bytes(2 * (patches + corners), counts.seen_patches) +
           GlossShading::most_lobe_bytes(patches, counts.seen_patches) + patches + numbers +
           kGrown * (kRowsAtOnce * row_of_points + threads * row_of_hits);
}

} // namespace kokage

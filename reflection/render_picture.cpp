#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/backdrop.h"
#include "reflection/camera_ray_shading.h"
#include "reflection/camera_rays.h"
#include "reflection/final_gather.h"
#include "reflection/gloss_in_view.h"
#include "reflection/gloss_shading.h"
#include "reflection/light_rays.h"
#include "reflection/picture.h"
#include "reflection/relief_surfaces.h"
#include "reflection/sample_plan.h"
#include "reflection/surface_shading.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Working space of one thread.
struct DrawingScratch {
    ShadingScratch shading;
    LightRays light_rays;
    std::vector<CameraHit> hits;
    std::vector<UnlitHit> unlit;
    std::vector<LightFromLights> light;
};

/// Draws squares of the picture: first rays, and as many more as the plan gives.
class PictureDrawing {
  public:
    PictureDrawing(const CameraRayShading& shading, const CameraFrame& frame, const PictureOptions& options)
        : shading_(shading), frame_(frame), options_(options), first_(SamplePlan::first_samples(options.samples)) {}

    Picture draw(Progress& progress) const {
        Film film(options_, frame_);
        const SamplePlan plan(scattered_spreads(), options_.samples, first_);
        progress.begin("rendering the picture", std::size_t(film.band_count()));
        parallel_blocks(std::size_t(film.band_count()), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t band = begin; band < end; ++band) {
                progress.throw_if_stopped();
                draw_band(film, int(band), plan);
                progress.advance(1);
            }
        });
        return film.picture();
    }

  private:
    /// Rays of a square's sequence that are to be traced.
    struct Square {
        int x, y;
        std::uint32_t begin, end;
    };

    /// Adds what the rays of `squares` see to `samples`, in their order. Rays of one call for a square are spread
    /// evenly over lights and lobes.
    void trace(const std::vector<Square>& squares, DrawingScratch& scratch, std::vector<CameraSample>& samples) const {
        constexpr std::size_t kAtOnce = 512;
        for (std::size_t first = 0, last = 0; first < squares.size(); first = last) {
            std::vector<CameraHit>& hits = scratch.hits;
            hits.clear();
            const std::size_t before = samples.size();
            for (; last < squares.size() && hits.size() < kAtOnce; ++last) {
                const Square& square = squares[last];
                const SquareRays rays(frame_, options_, square.x, square.y);
                for (std::uint32_t s = square.begin; s < square.end; ++s) {
                    CameraSample& sample = samples.emplace_back();
                    sample.place = rays.place(s);
                    sample.direction = rays.direction(sample.place);
                    hits.emplace_back().direction = sample.direction;
                }
            }
            shading_.relief.first_hits(hits);
            scratch.light_rays.clear();
            scratch.unlit.clear();
            for (std::size_t i = first; i < last; ++i) {
                const Square& square = squares[i];
                const SquareRays rays(frame_, options_, square.x, square.y);
                for (std::uint32_t s = square.begin; s < square.end; ++s) {
                    const std::size_t k = scratch.unlit.size();
                    scratch.unlit.push_back(shading_.unlit(frame_.position, hits[k],
                                                           rays.index(s, square.begin, square.end), std::uint32_t(k),
                                                           scratch.light_rays, scratch.shading));
                }
            }
            scratch.light.assign(hits.size(), {});
            scratch.light_rays.trace(shading_.queries, scratch.light);
            for (std::size_t k = 0; k < hits.size(); ++k)
                samples[before + k].seen =
                    shading_.lit(scratch.unlit[k], hits[k].direction, scratch.light[k], scratch.shading);
        }
    }

    /// Of squares here and there, so that the plan knows what the picture is like.
    std::vector<double> scattered_spreads() const {
        constexpr int kStep = 5;
        if (first_ >= options_.samples)
            return {};
        const int rows = (options_.height + kStep - 1) / kStep, columns = (options_.width + kStep - 1) / kStep;
        std::vector<double> spreads(std::size_t(rows) * std::size_t(columns));
        parallel_blocks(std::size_t(rows), 4, [&](std::size_t begin, std::size_t end) {
            DrawingScratch scratch;
            std::vector<CameraSample> samples;
            std::vector<Square> squares;
            for (std::size_t row = begin; row < end; ++row) {
                samples.clear();
                squares.clear();
                // Every row begins elsewhere, so that upright edges are not met or missed all together.
                for (int column = 0; column < columns; ++column)
                    squares.push_back({std::min(options_.width - 1, column * kStep + int(2 * row) % kStep),
                                       int(row) * kStep, 0, std::uint32_t(first_)});
                trace(squares, scratch, samples);
                for (std::size_t column = 0; column < squares.size(); ++column)
                    spreads[row * squares.size() + column] =
                        spread_of(samples.data() + column * std::size_t(first_), std::size_t(first_));
            }
        });
        return spreads;
    }

    void draw_band(Film& film, int band, const SamplePlan& plan) const {
        const int columns = options_.width + 2, first_row = film.first_row(band), rows = film.end_row(band) - first_row;
        const auto first = std::size_t(first_);
        DrawingScratch scratch;
        std::vector<Square> squares;
        for (int row = 0; row < rows; ++row)
            for (int x = 0; x < columns; ++x)
                squares.push_back({x - 1, first_row + row, 0, std::uint32_t(first_)});
        std::vector<CameraSample> begun, more, samples;
        begun.reserve(squares.size() * first);
        trace(squares, scratch, begun);
        std::vector<double> spreads;
        for (std::size_t k = 0; k < squares.size(); ++k)
            spreads.push_back(spread_of(begun.data() + k * first, first));
        for (int row = 0; row < rows; ++row) {
            std::vector<Square> rest;
            for (int x = 0; x < columns; ++x)
                rest.push_back({x - 1, first_row + row, std::uint32_t(first_),
                                std::uint32_t(plan.count(spread_around(spreads, rows, columns, row, x)))});
            more.clear();
            trace(rest, scratch, more);
            auto next = more.begin();
            for (int x = 0; x < columns; ++x) {
                const auto from = begun.begin() + std::ptrdiff_t(first) * (row * columns + x);
                samples.assign(from, from + std::ptrdiff_t(first));
                const Square& square = rest[std::size_t(x)];
                const auto end = next + std::ptrdiff_t(square.end - square.begin);
                samples.insert(samples.end(), next, end);
                next = end;
                film.add(band, square.x, square.y, samples);
            }
        }
    }

    /// Root of the mean variance of a square and its neighbours in the band: few rays often miss what is narrow.
    static double spread_around(const std::vector<double>& spreads, int rows, int columns, int row, int x) {
        double sum = 0;
        int count = 0;
        for (int j = std::max(0, row - 1); j <= std::min(rows - 1, row + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(columns - 1, x + 1); ++i, ++count) {
                const double spread = spreads[std::size_t(j) * std::size_t(columns) + std::size_t(i)];
                sum += spread * spread;
            }
        return std::sqrt(sum / count);
    }

    const CameraRayShading& shading_;
    const CameraFrame& frame_;
    const PictureOptions& options_;
    int first_;
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
    SurfaceShading surfaces(scene, queries, lights, options.pixel_shadows);
    const GroundLook ground(scene, queries, environment, backdrop, camera, options);
    WorkReport report;
    const GroundShading ground_light(scene, queries, environment, backdrop, ground, lights, progress);
    const IncomingRadiance incoming(queries, environment, surfaces, ground, ground_light);
    GlossShading gloss(scene, environment, surfaces, incoming, lobes_to_bake(scene, frame, options.skips, report),
                       progress, report);
    const ReliefSurfaces relief(scene, queries, environment, frame, options.skips.thin_relief, progress, report);
    gather_for_camera(scene, relief, frame, options, incoming, environment, surfaces, gloss, progress, report);
    const CameraRayShading shading{queries, backdrop, lights, surfaces, ground, ground_light, gloss, relief};

    Picture picture = PictureDrawing(shading, frame, options).draw(progress);
    picture.report = report;
    return picture;
}

} // namespace kokage

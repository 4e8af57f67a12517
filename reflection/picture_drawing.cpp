#include "reflection/picture_drawing.h"
#include "common/services/parallel.h"
#include "reflection/sample_plan.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace kokage {
namespace {

constexpr std::size_t kRaysAtOnce = 512;

/// Working space of one thread.
struct DrawingScratch {
    ShadingScratch shading;
    LightRays light_rays;
    std::vector<CameraHit> hits;
    std::vector<UnlitHit> unlit;
    std::vector<CoverageRay> coverage;
    std::vector<LightFromLights> light;
};

/// Draws squares of the picture: first rays, and as many more as the plan gives.
class PictureDrawing {
  public:
    PictureDrawing(const CameraRayShading& shading, const CameraFrame& frame, const PictureOptions& options)
        : shading_(shading), frame_(frame), options_(options), first_(SamplePlan::first_samples(options.samples)) {}

    Picture draw(Progress& progress, WorkReport& report) const {
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
        report.counts.push_back({"camera rays", shaded_});
        report.counts.push_back({"coverage rays", covering_});
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
        for (std::size_t first = 0, last = 0; first < squares.size(); first = last) {
            std::vector<CameraHit>& hits = scratch.hits;
            hits.clear();
            const std::size_t before = samples.size();
            for (; last < squares.size() && hits.size() < kRaysAtOnce; ++last) {
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

    /// Of squares here and there, each with its neighbours, so that the plan knows what the picture is like.
    std::vector<double> scattered_spreads() const {
        constexpr double kSquares = 1000; // enough to know their mean to a few per cent
        if (first_ >= options_.samples)
            return {};
        const int step = std::clamp(int(std::sqrt(double(options_.width) * options_.height / kSquares)), 3, 15);
        const int rows = (options_.height + step - 1) / step, columns = (options_.width + step - 1) / step;
        std::vector<double> spreads(std::size_t(rows) * std::size_t(columns));
        parallel_blocks(std::size_t(rows), 4, [&](std::size_t begin, std::size_t end) {
            DrawingScratch scratch;
            for (std::size_t row = begin; row < end; ++row)
                for (int column = 0; column < columns; ++column) {
                    // Every row begins elsewhere, so that upright edges are not met or missed all together.
                    const int x = std::min(options_.width - 1, column * step + int(2 * row) % step);
                    spreads[row * std::size_t(columns) + std::size_t(column)] =
                        spread_about(x, int(row) * step, scratch);
                }
        });
        return spreads;
    }

    /// What is left to be shaded away in a square, by its first rays and its eight neighbours'.
    double spread_about(int x, int y, DrawingScratch& scratch) const {
        std::vector<Square> squares;
        for (int j = -1; j <= 1; ++j)
            for (int i = -1; i <= 1; ++i)
                squares.push_back({x + i, y + j, 0, std::uint32_t(first_)});
        std::vector<CameraSample> samples;
        trace(squares, scratch, samples);
        return deviation(spreads_of(samples), 3, 3, 1, 1);
    }

    std::vector<RadianceSpread> spreads_of(std::span<const CameraSample> first_samples) const {
        std::vector<RadianceSpread> spreads;
        for (std::size_t begin = 0; begin < first_samples.size(); begin += std::size_t(first_))
            spreads.push_back(spread_of(first_samples.subspan(begin, std::size_t(first_))));
        return spreads;
    }

    /// Of rays that are to be shaded, in a square among others of known spread.
    static double deviation(const std::vector<RadianceSpread>& spreads, int rows, int columns, int row, int x) {
        RadianceSpread spread = spread_beside(spreads, rows, columns, row, x);
        const int coverage_rays = spread.coverage_rays();
        spread.add(spreads[std::size_t(row) * std::size_t(columns) + std::size_t(x)]);
        return spread.deviation(coverage_rays);
    }

    /// How a square's rays go on after the first.
    struct SquarePlan {
        std::uint32_t shaded, coverage; ///< in all
    };

    SquarePlan plan_of(const SamplePlan& plan, const std::vector<RadianceSpread>& spreads, int rows, int columns,
                       int row, int x) const {
        const RadianceSpread beside = spread_beside(spreads, rows, columns, row, x);
        const auto shaded = std::uint32_t(plan.count(deviation(spreads, rows, columns, row, x)));
        const int coverage = beside.coverage_rays();
        // Where neighbours call for no more than the first shaded rays, coverage hardly matters either.
        const bool worthwhile = plan.count(beside.deviation(coverage)) > first_;
        return {shaded, worthwhile ? std::uint32_t(coverage) * shaded : 0};
    }

    void draw_band(Film& film, int band, const SamplePlan& plan) const {
        const int columns = options_.width + 2, first_row = film.first_row(band), rows = film.end_row(band) - first_row;
        const auto first = std::size_t(first_);
        DrawingScratch scratch;
        std::vector<Square> squares;
        for (int row = 0; row < rows; ++row)
            for (int x = 0; x < columns; ++x)
                squares.push_back({x - 1, first_row + row, 0, std::uint32_t(first_)});
        std::vector<CameraSample> begun, more;
        begun.reserve(squares.size() * first);
        trace(squares, scratch, begun);
        const std::vector<RadianceSpread> spreads = spreads_of(begun);
        for (int row = 0; row < rows; ++row) {
            std::vector<Square> rest, covered;
            for (int x = 0; x < columns; ++x) {
                const SquarePlan rays = plan_of(plan, spreads, rows, columns, row, x);
                rest.push_back({x - 1, first_row + row, std::uint32_t(first_), rays.shaded});
                covered.push_back({x - 1, first_row + row, rays.shaded, rays.shaded + rays.coverage});
            }
            trace_coverage(covered, scratch);
            more.clear();
            trace(rest, scratch, more);
            RowSamples all = row_samples(row, rest, covered, begun, more, scratch.coverage);
            add_looks(all, covered, scratch);
            for (std::size_t x = 0; x < rest.size(); ++x)
                film.add(band, rest[x].x, rest[x].y, all.of_square(x));
            shaded_ += all.shaded.size() + all.looks.size();
            covering_ += all.coverage.size();
        }
    }

    /// A row's rays, square by square.
    struct RowSamples {
        std::vector<CameraSample> shaded, looks;
        std::span<const CoverageRay> coverage;
        std::vector<std::size_t> shaded_ends{0}, coverage_ends{0},
            looks_ends{0}; ///< of the squares, from the second on

        SquareSamples of_square(std::size_t x) const {
            const auto part = [&](const auto& values, const std::vector<std::size_t>& ends) {
                return std::span(values).subspan(ends[x], ends[x + 1] - ends[x]);
            };
            return {part(shaded, shaded_ends), part(coverage, coverage_ends),
                    looks_ends.size() > x + 1 ? part(looks, looks_ends) : std::span<const CameraSample>()};
        }
    };

    RowSamples row_samples(int row, const std::vector<Square>& rest, const std::vector<Square>& covered,
                           std::span<const CameraSample> begun, std::span<const CameraSample> more,
                           std::span<const CoverageRay> coverage) const {
        RowSamples all;
        all.coverage = coverage;
        const auto first = std::size_t(first_);
        std::size_t next = 0;
        for (std::size_t x = 0; x < rest.size(); ++x) {
            const auto of_begun = begun.subspan(first * (std::size_t(row) * rest.size() + x), first),
                       of_more = more.subspan(next, rest[x].end - rest[x].begin);
            all.shaded.insert(all.shaded.end(), of_begun.begin(), of_begun.end());
            all.shaded.insert(all.shaded.end(), of_more.begin(), of_more.end());
            all.shaded_ends.push_back(all.shaded.size());
            all.coverage_ends.push_back(all.coverage_ends.back() + covered[x].end - covered[x].begin);
            next += of_more.size();
        }
        return all;
    }

    /// Shades a coverage ray of each class of a square that it has no shaded ray of.
    void add_looks(RowSamples& all, const std::vector<Square>& covered, DrawingScratch& scratch) const {
        std::vector<Square> squares;
        std::vector<std::size_t> ends{0};
        for (std::size_t x = 0; x < covered.size(); ++x) {
            const SquareSamples samples = all.of_square(x);
            if (!samples.coverage.empty())
                add_unshaded(samples, covered[x], squares);
            ends.push_back(squares.size());
        }
        trace(squares, scratch, all.looks);
        all.looks_ends = std::move(ends);
    }

    static void add_unshaded(const SquareSamples& samples, const Square& covered, std::vector<Square>& rays) {
        const std::vector<std::uint32_t> parts = samples.parts();
        for (const std::size_t ray :
             rays_of_unshaded_classes(CoverageClasses(samples.coverage, parts), samples.coverage, parts)) {
            const std::uint32_t number = covered.begin + std::uint32_t(ray);
            rays.push_back({covered.x, covered.y, number, number + 1});
        }
    }

    /// Coverage rays of `squares`, in their order.
    void trace_coverage(const std::vector<Square>& squares, DrawingScratch& scratch) const {
        std::vector<CoverageRay>& coverage = scratch.coverage;
        coverage.clear();
        scratch.hits.resize(kRaysAtOnce);
        std::size_t waiting = 0;
        const auto find_parts = [&] {
            const std::span<CameraHit> hits = std::span(scratch.hits).first(waiting);
            shading_.relief.first_hits(hits);
            for (std::size_t k = 0; k < waiting; ++k)
                coverage[coverage.size() - waiting + k].part = shading_.part_met(frame_.position, hits[k]);
            waiting = 0;
        };
        for (const Square& square : squares) {
            const SquareRays rays(frame_, options_, square.x, square.y);
            for (std::uint32_t s = square.begin; s < square.end; ++s) {
                CoverageRay& ray = coverage.emplace_back();
                ray.place = rays.place(s);
                scratch.hits[waiting++].direction = rays.direction(ray.place);
                if (waiting == kRaysAtOnce)
                    find_parts();
            }
        }
        find_parts();
    }

    /// Of a square's neighbours in the band: few rays often miss what is narrow.
    static RadianceSpread spread_beside(const std::vector<RadianceSpread>& spreads, int rows, int columns, int row,
                                        int x) {
        RadianceSpread sum;
        for (int j = std::max(0, row - 1); j <= std::min(rows - 1, row + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(columns - 1, x + 1); ++i)
                if (j != row || i != x)
                    sum.add(spreads[std::size_t(j) * std::size_t(columns) + std::size_t(i)]);
        return sum;
    }

    const CameraRayShading& shading_;
    const CameraFrame& frame_;
    const PictureOptions& options_;
    int first_;
    mutable std::atomic<std::size_t> shaded_ = 0, covering_ = 0; ///< of the picture's squares
};

} // namespace

Picture draw_picture(const CameraRayShading& shading, const CameraFrame& frame, const PictureOptions& options,
                     Progress& progress, WorkReport& report) {
    return PictureDrawing(shading, frame, options).draw(progress, report);
}

} // namespace kokage

#include "common/directions/about_axis.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "common/services/stopwatch.h"
#include "reflection/relief/relief_openness.h"
#include "reflection/sampling.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_judge.h"
#include "tests/benchmark/relief_maps.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

const ReliefScale kScale{glm::vec2(1.f), kBenchReliefDepth};
/// Rays start this much above the surface: kShadowLift would take them out of a steep texel's own shade.
constexpr float kLift = 2e-6f;

/// A point of the surface, and the normal that its light is weighted about.
struct OpenPoint {
    glm::vec2 coordinate{0.f};
    float depth = 0;
    glm::vec3 normal{0, 0, 1};
};

glm::vec2 slope_at(const HeightField& field, const glm::vec2& coordinate) {
    return glm::vec2(true_relief_hit(field, {glm::vec3(coordinate, 0.f), glm::vec3(0, 0, 1)}).slope);
}

/// The mean of the four cells that meet at a texel's centre.
glm::vec2 mean_slope(const HeightField& field, const glm::vec2& texel) {
    const glm::vec2 aside = 1e-3f / glm::vec2(field.width, field.height);
    glm::vec2 sum(0.f);
    for (const glm::vec2 way : {glm::vec2(1, 1), glm::vec2(1, -1), glm::vec2(-1, 1), glm::vec2(-1, -1)})
        sum += slope_at(field, texel + way * aside);
    return 0.25f * sum;
}

/// Texels drawn at random, or places between them.
std::vector<OpenPoint> points_of(const HeightField& field, bool at_texels, OpennessNormal normal, std::size_t count) {
    Random random(at_texels ? 1 : 2);
    const glm::vec2 size(field.width, field.height);
    std::vector<OpenPoint> points(count);
    for (OpenPoint& point : points) {
        glm::vec2 texel = size * glm::vec2(random.uniform(), random.uniform());
        if (at_texels)
            texel = glm::min(glm::floor(texel), size - 1.f) + 0.5f;
        point.coordinate = texel / size;
        point.depth = float(true_relief_hit(field, {glm::vec3(point.coordinate, 0.f), glm::vec3(0, 0, 1)}).depth);
        if (normal == OpennessNormal::surface)
            point.normal = relief_normal(
                at_texels ? mean_slope(field, point.coordinate) : slope_at(field, point.coordinate), kScale);
    }
    return points;
}

/// Share of a uniform sky's light that reaches each point: `rays` exact shadow rays each.
std::vector<double> true_openness(const ReliefTracer& tracer, std::span<const OpenPoint> points, std::uint32_t rays,
                                  Progress& progress) {
    std::vector<double> open(points.size());
    parallel_blocks(points.size(), 16, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        std::vector<ReliefRay> sky(rays);
        std::vector<std::uint8_t> hidden(rays);
        for (std::size_t k = begin; k < end; ++k) {
            ReliefHit from;
            from.coordinate = points[k].coordinate;
            from.depth = points[k].depth + kShadowLift - kLift;
            for (std::uint32_t r = 0; r < rays; ++r)
                sky[r] = relief_shadow_ray(
                    from, about_axis(cosine_direction(multi_jittered(r, rays, std::uint32_t(k))), points[k].normal),
                    kScale);
            tracer.occluded(sky, hidden);
            open[k] = 1 - double(std::count(hidden.begin(), hidden.end(), 1)) / rays;
        }
    });
    return open;
}

double rms(const ReliefOpenness& openness, std::span<const OpenPoint> points, std::span<const double> truth) {
    double sum = 0;
    for (std::size_t k = 0; k < points.size(); ++k)
        sum += std::pow(double(openness.lookup(points[k].coordinate)) - truth[k], 2);
    return std::sqrt(sum / double(points.size()));
}

/// One kind of openness, made and judged.
void measure_openness(const ReliefExperimentContext& context, const BenchmarkMap& map, const ReliefTracer& exact,
                      OpennessNormal normal, const std::string& method, const std::function<ReliefOpenness()>& make) {
    ReliefRecord record = record_of("occlusion", map, method);
    const Stopwatch watch;
    const ReliefOpenness openness = make();
    record.preprocess_cpu_seconds = watch.cpu();
    record.bytes = double(openness.bytes());
    for (const bool at_texels : {true, false}) {
        const std::vector<OpenPoint> points = points_of(map.field, at_texels, normal, context.quick ? 400 : 4000);
        const std::uint32_t rays = context.quick ? 1024 : 4096;
        const std::vector<double> truth = true_openness(exact, points, rays, context.progress);
        record.view = at_texels ? "texels" : "between";
        record.rays = points.size();
        record.rms_error = rms(openness, points, truth);
        record.note = std::to_string(rays) + " exact rays a point";
        context.take(record);
    }
}

} // namespace

void measure_relief_occlusion(const ReliefExperimentContext& context) {
    for (const BenchmarkMap& map : context.reliefs.maps()) {
        ReliefRecord unused;
        const ReliefTracer& exact = context.reliefs.tracer(map, benchmark_methods().front(), unused);
        for (const OpennessNormal normal : {OpennessNormal::surface, OpennessNormal::plane})
            measure_openness(
                context, map, exact, normal, normal == OpennessNormal::surface ? "horizons" : "horizons-plane",
                [&] { return horizon_openness(map.field, {.scale = kScale, .normal = normal}, context.progress); });
        measure_openness(context, map, exact, OpennessNormal::plane, "depth-maps-256-plane", [&] {
            DepthMapSettings settings;
            settings.scale = kScale;
            settings.size = 256; // eq 2's shrinking takes neighbours that are less deep for what hides a texel
            return depth_map_openness(map.field, trace_depth_maps(settings, exact, context.progress),
                                      OpennessNormal::plane, 1.f / 32, context.progress);
        });
    }
}

} // namespace kokage

#include "common/services/stopwatch.h"
#include "tests/benchmark/relief_experiments.h"
#include "tests/benchmark/relief_judge.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/benchmark/relief_views.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// From the true hits of a view towards a light.
std::vector<ReliefRay> shadow_rays(std::span<const TrueReliefHit> hits, float elevation_degrees) {
    const ReliefScale scale{glm::vec2(1.f), kBenchReliefDepth};
    const float elevation = glm::radians(elevation_degrees), azimuth = 0.7f;
    const glm::vec3 to_light(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                             std::sin(elevation));
    std::vector<ReliefRay> rays;
    for (const TrueReliefHit& hit : hits)
        if (hit.found())
            rays.push_back(relief_shadow_ray({.t = float(hit.t),
                                              .coordinate = glm::vec2(hit.coordinate),
                                              .depth = float(hit.depth),
                                              .slope = glm::vec2(hit.slope)},
                                             to_light, scale));
    return rays;
}

void judge_shadows(const HeightField& field, std::span<const ReliefRay> rays, std::span<const std::uint8_t> hidden,
                   std::span<const TrueReliefHit> truth, ReliefRecord& record) {
    record.wrong = record.ties = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        if (bool(hidden[k]) == truth[k].found())
            continue;
        const double deepest = greatest_depth_below(field, rays[k], 0, HUGE_VAL);
        ++*(std::abs(deepest) <= kTieDepth ? record.ties : record.wrong);
    }
}

} // namespace

void measure_relief_shadows(const ReliefExperimentContext& context) {
    const ReliefView view = plane_view(25, context.quick ? 160 : 512, 2);
    for (const BenchmarkMap& map : context.reliefs.maps()) {
        const std::vector<TrueReliefHit> seen = true_hits(map.field, view.rays, context.progress);
        for (const BenchmarkMethod& method : benchmark_methods()) {
            ReliefRecord record = record_of("shadows", map, method.name);
            const ReliefTracer& tracer = context.reliefs.tracer(map, method, record);
            for (const float elevation : {10.f, 30.f, 60.f}) {
                context.progress.throw_if_stopped();
                const std::vector<ReliefRay> rays = shadow_rays(seen, elevation);
                const std::vector<TrueReliefHit> truth = true_hits(map.field, rays, context.progress);
                std::vector<std::uint8_t> hidden(rays.size());
                std::vector<std::uint32_t> reads(rays.size());
                const Stopwatch watch;
                tracer.occluded(rays, hidden, reads);
                record.view = "light-" + std::to_string(int(elevation));
                record.rays = rays.size();
                record.ns_per_ray = 1e9 * watch.cpu() / double(std::max<std::size_t>(1, rays.size()));
                double sum = 0;
                for (const std::uint32_t one : reads)
                    sum += one;
                record.reads_mean = sum / double(std::max<std::size_t>(1, rays.size()));
                judge_shadows(map.field, rays, hidden, truth, record);
                context.take(record);
            }
        }
    }
}

} // namespace kokage

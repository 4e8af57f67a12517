#include "tests/benchmark/relief_judge.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Texels that a ray covers in a unit of t.
double texels_a_unit(const HeightField& field, const ReliefRay& ray, double depth_in_tiles) {
    const glm::dvec3 d(ray.direction);
    const double size = std::max(field.width, field.height);
    return std::hypot(d.x * field.width, d.y * field.height, d.z * depth_in_tiles * size);
}

/// The surface is touched between the nearer and the further of two answers, but not entered deeper than rounding.
bool is_tie(const HeightField& field, const ReliefRay& ray, double t, double t_true) {
    if (std::isinf(t) && ray.direction.z > 0) // what goes down hits something, if only the ground at depth 1
        return false;
    if (t_true < t) // something was passed: how deep did the ray get in it?
        return greatest_depth_below(field, ray, t_true, t) <= kTieDepth;
    // Something was hit: how near does the ray come to it? A hit's t is a float: look a little to and fro.
    const double rounding = 0.05 / texels_a_unit(field, ray, 0);
    return greatest_depth_below(field, ray, t - rounding, t + rounding) >= -kTieDepth;
}

} // namespace

std::vector<TrueReliefHit> true_hits(const HeightField& field, std::span<const ReliefRay> rays, Progress& progress) {
    std::vector<TrueReliefHit> truth(rays.size());
    parallel_blocks(rays.size(), 4096, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t k = begin; k < end; ++k)
            truth[k] = true_relief_hit(field, rays[k]);
    });
    return truth;
}

void judge(const HeightField& field, std::span<const ReliefRay> rays, std::span<const ReliefHit> hits,
           std::span<const TrueReliefHit> truth, double depth_in_tiles, ReliefRecord& record) {
    std::uint64_t wrong = 0, ties = 0, reads = 0;
    std::vector<std::uint32_t> all_reads(rays.size());
    for (std::size_t k = 0; k < rays.size(); ++k) {
        all_reads[k] = hits[k].reads;
        reads += hits[k].reads;
        if (!hits[k].found() && !truth[k].found())
            continue;
        const double t = hits[k].t, t_true = truth[k].t;
        // The tracer's own t may be rounded; no hit is infinitely far from a hit.
        if (std::abs(t - t_true) * texels_a_unit(field, rays[k], depth_in_tiles) <= 0.5)
            continue;
        ++(is_tie(field, rays[k], t, t_true) ? ties : wrong);
    }
    record.rays = rays.size();
    record.wrong = wrong;
    record.ties = ties;
    if (rays.empty())
        return;
    record.reads_mean = double(reads) / double(rays.size());
    const auto p99 = all_reads.begin() + std::ptrdiff_t(double(all_reads.size() - 1) * 0.99);
    std::nth_element(all_reads.begin(), p99, all_reads.end());
    record.reads_p99 = *p99;
}

std::vector<ReliefHit> timed_trace(const ReliefTracer& tracer, std::span<const ReliefRay> rays, ReliefRecord& record) {
    std::vector<ReliefHit> hits(rays.size());
    std::vector<double> seconds;
    double total = 0;
    do {
        const Stopwatch watch;
        tracer.trace(rays, hits);
        seconds.push_back(watch.cpu());
        total += seconds.back();
    } while (seconds.size() < 5 && total < 0.5);
    std::sort(seconds.begin(), seconds.end());
    if (!rays.empty())
        record.ns_per_ray = 1e9 * seconds[seconds.size() / 2] / double(rays.size());
    return hits;
}

} // namespace kokage

#include "foliage/open_sky.h"
#include "common/services/parallel.h"
#include "foliage/cosine_direction.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {

namespace {

constexpr std::size_t kSampledPatches = 2048;
constexpr int kRaysASide = 16;

/// Share of rays from one side of a patch that hit no other patch (the ground counts as outside).
float measure_openness(const RayQueries& queries, const PatchPoints& points, std::uint32_t patch, float side,
                       std::uint64_t seed) {
    int open = 0;
    for (int i = 0; i < kRaysASide; ++i) {
        PathNumbers numbers(seed, std::uint32_t(i));
        PatchPoint point;
        if (!points.sample(patch, numbers, point))
            return 0;
        RayHit hit;
        open += !queries.first_hit(point.position, cosine_direction(side * point.normal, numbers.pair()),
                                   queries.ray_offset(), std::numeric_limits<float>::infinity(), hit) ||
                hit.ground;
    }
    return float(open) / float(kRaysASide);
}

} // namespace

OpenSky::OpenSky(const RayQueries& queries, std::uint64_t seed, Progress& progress) : points_(queries.scene()) {
    const std::size_t patches = queries.scene().patches.size(), count = std::min(patches, kSampledPatches);
    sampled_.resize(count);
    parallel_blocks(count, 64, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t i = begin; i < end; ++i) {
            Sampled& sampled = sampled_[i];
            sampled.patch = std::uint32_t(i * patches / count);
            sampled.open_front = measure_openness(queries, points_, sampled.patch, 1, hash64(seed ^ hash64(2 * i)));
            sampled.open_back = measure_openness(queries, points_, sampled.patch, -1, hash64(seed ^ hash64(2 * i + 1)));
        }
    });
    rays_ = 2 * count * kRaysASide;
}

double OpenSky::escaping_power(const SideRadiance& radiance) const {
    double sent_by_all = 0, sent_by_sampled = 0, escaped_of_sampled = 0;
    for (std::size_t p = 0; p < areas().size(); ++p)
        sent_by_all += areas()[p] * kPiDouble * (luminance(radiance.front[p]) + luminance(radiance.back[p]));
    for (const Sampled& sampled : sampled_) {
        const double front = areas()[sampled.patch] * kPiDouble * luminance(radiance.front[sampled.patch]);
        const double back = areas()[sampled.patch] * kPiDouble * luminance(radiance.back[sampled.patch]);
        sent_by_sampled += front + back;
        escaped_of_sampled += front * sampled.open_front + back * sampled.open_back;
    }
    return sent_by_sampled > 0 ? sent_by_all * (escaped_of_sampled / sent_by_sampled) : 0;
}

} // namespace kokage

#include "foliage/open_sky.h"
#include "common/services/parallel.h"
#include "foliage/patch_sampling.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {

namespace {

constexpr std::size_t kSampledPatches = 2048;
constexpr int kRaysASide = 16;

double sum(const glm::vec3& v) {
    return double(v.r) + v.g + v.b;
}

/// Share of rays from one side of a patch that hit no other patch (the ground counts as outside).
float measure_openness(const RayQueries& queries, std::uint32_t patch, float side, Random& random) {
    int open = 0;
    for (int i = 0; i < kRaysASide; ++i) {
        const PatchPoint point = sample_patch(queries.scene(), patch, random);
        const float u0 = (float(i / 4) + random.uniform()) / 4, u1 = (float(i % 4) + random.uniform()) / 4;
        const glm::vec3 direction = cosine_direction(side * point.normal, u0, u1);
        RayHit hit;
        open += !queries.first_hit(point.position, direction, queries.ray_offset(),
                                   std::numeric_limits<float>::infinity(), hit) ||
                hit.ground;
    }
    return float(open) / float(kRaysASide);
}

} // namespace

OpenSky::OpenSky(const RayQueries& queries, std::uint64_t seed, Progress& progress)
    : areas_(solid_areas(queries.scene())) {
    const std::size_t patches = queries.scene().patches.size(), count = std::min(patches, kSampledPatches);
    sampled_.resize(count);
    parallel_blocks(count, 64, [&](std::size_t begin, std::size_t end) {
        progress.throw_if_stopped();
        for (std::size_t i = begin; i < end; ++i) {
            Sampled& sampled = sampled_[i];
            sampled.patch = std::uint32_t(i * patches / count);
            Random random(seed, 0x6f70656e00000000ull + i);
            sampled.open_front = measure_openness(queries, sampled.patch, 1, random);
            sampled.open_back = measure_openness(queries, sampled.patch, -1, random);
        }
    });
    rays_ = 2 * count * kRaysASide;
}

double OpenSky::escaping_power(const SideRadiance& radiance) const {
    double sent_by_all = 0, sent_by_sampled = 0, escaped_of_sampled = 0;
    for (std::size_t p = 0; p < areas_.size(); ++p)
        sent_by_all += areas_[p] * kPiDouble * (sum(radiance.front[p]) + sum(radiance.back[p]));
    for (const Sampled& sampled : sampled_) {
        const double front = areas_[sampled.patch] * kPiDouble * sum(radiance.front[sampled.patch]);
        const double back = areas_[sampled.patch] * kPiDouble * sum(radiance.back[sampled.patch]);
        sent_by_sampled += front + back;
        escaped_of_sampled += front * sampled.open_front + back * sampled.open_back;
    }
    return sent_by_sampled > 0 ? sent_by_all * (escaped_of_sampled / sent_by_sampled) : 0;
}

} // namespace kokage

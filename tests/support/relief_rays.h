#pragma once
// Rays on the benchmark's maps, and how many of their hits are wrong.
#include "common/services/random.h"
#include "common/types.h"
#include "reflection/relief/cell_by_cell.h"
#include "tests/benchmark/relief_maps.h"

#include <algorithm>
#include <cmath>

namespace kokage {

/// On a plane of one tile with the benchmark's depth, from 10 to 85 degrees off its normal, from all sides.
inline std::vector<ReliefRay> view_rays(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    ReliefScale scale;
    scale.depth_m = kBenchReliefDepth;
    std::vector<ReliefRay> rays;
    for (std::size_t k = 0; k < count; ++k) {
        const float angle = random.uniform(10.f, 85.f) * kPi / 180, turn = random.uniform(0.f, 2 * kPi);
        const glm::vec2 at(random.uniform(), random.uniform());
        rays.push_back(relief_ray(
            at, {std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn), -std::cos(angle)}, scale));
    }
    return rays;
}

/// Smooth waves: no feature is thinner than a quarter of the tile.
inline HeightField smooth_field(int width, int height) {
    HeightField field{width, height, HeightWrap::repeat, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            field.depths.push_back(0.5f + 0.2f * std::sin(2 * kPi * (float(x) + 0.5f) / float(width)) +
                                   0.2f * std::cos(4 * kPi * (float(y) + 0.5f) / float(height)));
    return field;
}

struct WrongHits {
    std::size_t count = 0;  ///< more than half a texel from the true hit, or one of both hits nothing
    double worst_right = 0; ///< texels, of the others
    double worst_slope = 0; ///< of the others
    double reads_mean = 0;
};

inline WrongHits wrong_hits(const HeightField& field, const std::vector<ReliefRay>& rays,
                            const std::vector<ReliefHit>& hits) {
    WrongHits wrong;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        wrong.reads_mean += double(hits[k].reads) / double(rays.size());
        const TrueReliefHit truth = true_relief_hit(field, rays[k]);
        if (!truth.found() && !hits[k].found())
            continue;
        const double texels = std::abs(double(hits[k].t) - truth.t) *
                              double(glm::length(glm::vec2(rays[k].direction) * glm::vec2(field.width, field.height)));
        if (hits[k].found() != truth.found() || texels > 0.5) {
            ++wrong.count;
            continue;
        }
        wrong.worst_right = std::max(wrong.worst_right, texels);
        wrong.worst_slope = std::max(wrong.worst_slope, glm::length(glm::dvec2(hits[k].slope) - truth.slope));
    }
    return wrong;
}

} // namespace kokage

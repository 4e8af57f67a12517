#include "trees/growth/crown.h"

#include "common/services/random.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/streams.h"

#include <algorithm>
#include <cmath>

namespace kokage {

Crown::Crown(const GrowthParameters& p)
    : lobe_depth_(float(p.crown_lobe_depth)), roundness_(float(p.crown_roundness)), shell_(float(p.crown_shell)),
      clumping_(float(p.crown_clumping)), seed_(p.seed) {
    const double projection = p.leaves * mean_leaf_area(p) / p.leaf_area_index;
    // The hollows between billows take more of the crown's projection than shoots beyond the outline add: measured over
    // seeds, the crown that grows has 0.92 times the projection of its nominal outline. A seedling is never smaller
    // than its leaves.
    constexpr double grown_share = 0.92;
    const double smallest = 0.8 * (p.leaf_length + p.shoot_length);
    radius_m = float(std::max(std::sqrt(projection / (grown_share * kPiDouble)), smallest));
    height_m = float(2 * radius_m * p.height_to_width);
    base_m = float(height_m * p.crown_base);
    widest_m = float(base_m + (height_m - base_m) * p.crown_widest);
    lower_depth_m_ =
        float((widest_m - base_m) / std::pow(1 - std::pow(p.crown_bottom, p.crown_roundness), 1 / p.crown_roundness));
    Random random(seed_, streams::crown_lobes);
    for (int i = 0; i < p.crown_lobes; ++i) {
        // A jittered Fibonacci spiral over the sphere.
        const float y = 1 - 2 * (float(i) + random.uniform()) / float(p.crown_lobes);
        const float azimuth = 2.39996323f * float(i) + random.uniform(-0.6f, 0.6f),
                    r = std::sqrt(std::max(0.f, 1 - y * y));
        lobes_.push_back({{r * std::cos(azimuth), y, r * std::sin(azimuth)}, random.uniform(0.45f, 1.f)});
    }
    base_phases_ = {random.uniform(0.f, 2 * kPi), random.uniform(0.f, 2 * kPi), random.uniform(0.f, 2 * kPi)};
    // A lobe's angular half-width is about half the distance to its neighbours.
    lobe_sharpness_ = float(p.crown_lobes) / 5.f;
}

glm::vec3 Crown::normalised(const glm::vec3& point) const {
    const float y = point.y - widest_m;
    return {point.x / radius_m, y / (y >= 0 ? height_m - widest_m : lower_depth_m_), point.z / radius_m};
}

/// Height of the crown's base in a point's direction from the trunk: it rises and sinks a little around the tree.
float Crown::base_towards(const glm::vec3& point) const {
    const float azimuth = std::atan2(point.z, point.x);
    const float wave = std::cos(2 * azimuth + base_phases_.x) + std::cos(3 * azimuth + base_phases_.y) +
                       std::cos(5 * azimuth + base_phases_.z);
    return base_m + 0.11f * (widest_m - base_m) * wave;
}

float Crown::lobe_scale(const glm::vec3& direction) const {
    if (lobes_.empty())
        return 1.f;
    float best = 0;
    for (const Lobe& lobe : lobes_)
        best = std::max(best, lobe.size * std::exp(lobe_sharpness_ * (glm::dot(direction, lobe.direction) - 1)));
    return 1 - lobe_depth_ * (1 - best);
}

float Crown::relative_distance(const glm::vec3& point) const {
    const glm::vec3 n = normalised(point);
    const float length = glm::length(n);
    if (length < 1e-6f)
        return 0;
    const float super =
        std::pow(std::pow(std::hypot(n.x, n.z), roundness_) + std::pow(std::abs(n.y), roundness_), 1 / roundness_);
    return super / lobe_scale(n / length);
}

Crown::Attractors Crown::attractors(int count) const {
    Random random(seed_, streams::attractors);
    const float lowest = base_m - 0.33f * (widest_m - base_m);
    const auto point_in_box = [&] {
        return glm::vec3(random.uniform(-radius_m, radius_m), random.uniform(lowest, height_m),
                         random.uniform(-radius_m, radius_m));
    };
    // The crown's edge belongs to it: shoots and leaves grow a little beyond the points, so the points stay a little
    // inside.
    const auto density = [&](const glm::vec3& point) {
        const float distance = relative_distance(point);
        return distance > 1 || point.y < base_towards(point) ? 0.f : 0.04f + 0.96f * std::pow(distance, shell_);
    };
    Attractors result;
    std::vector<glm::vec3> clumps;
    const std::size_t clump_count = std::size_t(std::max(1, count / 14));
    std::size_t tried = 0;
    const std::size_t most = 4000 * (std::size_t(count) + 100);
    const auto draw = [&](std::vector<glm::vec3>& points, std::size_t until) {
        while (points.size() < until && tried++ < most)
            if (const glm::vec3 p = point_in_box(); random.uniform() < density(p))
                points.push_back(p);
    };
    draw(result.points, std::size_t(std::lround(double(count) * (1 - clumping_))));
    draw(clumps, clump_count);
    const float box = 4 * radius_m * radius_m * (height_m - lowest);
    const float clump_radius = 0.5f * std::cbrt(box / float(clump_count) * 0.35f);
    while (result.points.size() < std::size_t(count) && !clumps.empty() && tried++ < 2 * most) {
        const glm::vec3 centre = clumps[random.below(std::uint32_t(clumps.size()))];
        const glm::vec3 offset{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const glm::vec3 p = centre + clump_radius * glm::vec3(offset.x, 0.7f * offset.y, offset.z);
        if (glm::length(offset) < 1 && p.y >= base_towards(p) && relative_distance(p) < 1.03f)
            result.points.push_back(p);
    }
    while (result.points.size() < std::size_t(count)) // a crown too thin to hit by chance
        result.points.push_back({0, random.uniform(base_m, height_m), 0});
    // Where the crown is full, points are as dense as if the whole box were filled with 1.6 times as many.
    result.spacing_m = std::cbrt(box / (1.6f * float(count)));
    return result;
}

} // namespace kokage

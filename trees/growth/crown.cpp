#include "trees/growth/crown.h"

#include "trees/growth/directions.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/streams.h"
#include "trees/growth/young_tree.h"

#include <algorithm>
#include <cmath>

namespace kokage {

Crown::Crown(const GrowthParameters& p) : p_(p) {
    const double projection = p.leaves * mean_leaf_area(p) / p.leaf_area_index;
    // The hollows between billows take more of the crown's projection than shoots beyond the outline add: measured over
    // seeds, the crown that grows has 0.92 times the projection of its nominal outline. It is never smaller than its
    // shoots and leaves; a seedling is little more than a leaf.
    constexpr double grown_share = 0.92;
    const double smallest = std::lerp(0.8 * (p.leaf_length + p.shoot_length), 0.35 * p.leaf_length, youth(p));
    radius_m = float(std::max(std::sqrt(projection / (grown_share * kPiDouble)), smallest));
    height_m = float(2 * radius_m * p.height_to_width);
    base_m = float(height_m * p.crown_base);
    widest_m = float(base_m + (height_m - base_m) * p.crown_widest);
    lower_depth_m_ =
        float((widest_m - base_m) / std::pow(1 - std::pow(p.crown_bottom, p.crown_underside), 1 / p.crown_underside));
    Random random(p.seed, streams::crown_lobes);
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
    return 1 - float(p_.crown_lobe_depth) * (1 - best);
}

float Crown::relative_distance(const glm::vec3& point) const {
    const glm::vec3 n = normalised(point);
    const float length = glm::length(n);
    if (length < 1e-6f)
        return 0;
    const float e = float(n.y >= 0 ? p_.crown_roundness : p_.crown_underside);
    const float super = std::pow(std::pow(std::hypot(n.x, n.z), e) + std::pow(std::abs(n.y), e), 1 / e);
    return super / lobe_scale(n / length);
}

glm::vec3 Crown::lowest_corner() const {
    return {-radius_m, base_m - 0.33f * (widest_m - base_m), -radius_m};
}

float Crown::spacing_m(int count) const {
    // Where the crown is full, points are as dense as if the whole box were filled with 1.6 times as many.
    return std::cbrt(4 * radius_m * radius_m * (height_m - lowest_corner().y) / (1.6f * float(count)));
}

/// The crown's edge belongs to it: shoots and leaves grow a little beyond the points, so the points stay a little
/// inside.
float Crown::density(const glm::vec3& point) const {
    const float distance = relative_distance(point);
    return distance > 1 || point.y < base_towards(point) ? 0.f
                                                         : 0.04f + 0.96f * std::pow(distance, float(p_.crown_shell));
}

void Crown::draw_points(std::vector<glm::vec3>& points, std::size_t until, Random& random) const {
    const glm::vec3 low = lowest_corner(), high(radius_m, height_m, radius_m);
    for (std::size_t tries = 4000 * (until + 100); points.size() < until && tries > 0; --tries) {
        const float x = random.uniform(low.x, high.x), y = random.uniform(low.y, high.y),
                    z = random.uniform(low.z, high.z);
        if (random.uniform() < density({x, y, z}))
            points.emplace_back(x, y, z);
    }
}

void Crown::draw_in_clumps(std::vector<glm::vec3>& points, std::size_t until, Random& random) const {
    std::vector<glm::vec3> clumps;
    draw_points(clumps, std::max<std::size_t>(1, until / 14), random);
    if (clumps.empty())
        return;
    const float box = 4 * radius_m * radius_m * (height_m - lowest_corner().y);
    const float clump_radius = 0.5f * std::cbrt(box / float(clumps.size()) * 0.35f);
    for (std::size_t tries = 4000 * (until + 100); points.size() < until && tries > 0; --tries) {
        const glm::vec3 centre = clumps[random.below(std::uint32_t(clumps.size()))];
        const float x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
        const glm::vec3 p = centre + clump_radius * glm::vec3(x, 0.7f * y, z);
        if (glm::length(glm::vec3(x, y, z)) < 1 && p.y >= base_towards(p) && relative_distance(p) < 1.03f)
            points.push_back(p);
    }
}

/// A layer is a limb's own foliage: a level leaf-shaped sheet around it, `layer_width` wide and `layer_depth` deep.
void Crown::draw_in_layers(std::vector<glm::vec3>& points, std::size_t until, const std::vector<Limb>& limbs,
                           Random& random) const {
    std::vector<float> area_before{0.f};
    for (const Limb& limb : limbs)
        area_before.push_back(area_before.back() + std::pow(limb.length_m, 1.6f)); // between its length and its area
    if (area_before.back() <= 0)
        return;
    for (std::size_t tries = 400 * (until + 100); points.size() < until && tries > 0; --tries) {
        const auto next =
            std::upper_bound(area_before.begin() + 1, area_before.end() - 1, random.uniform() * area_before.back());
        const Limb& limb = limbs[std::size_t(next - area_before.begin()) - 1];
        const float along = random.uniform(float(p_.limb_bare), 1.06f), sideways = random.uniform(-1, 1),
                    depth = random.uniform(-1, 1);
        // Widest a third of the way, narrow at both ends.
        const float wide = std::sqrt(std::max(0.f, std::min(1.f, (along - float(p_.limb_bare) + 0.08f) / 0.3f))) *
                           std::sqrt(std::max(0.f, 1.1f - along));
        if (random.uniform() > wide)
            continue;
        const float place = std::min(along, 0.999f) * float(limb.course.size() - 1);
        const std::size_t i = std::size_t(place);
        const glm::vec3 a = limb.course[i], b = limb.course[i + 1];
        const glm::vec3 way = unit_or(b - a, {0, 1, 0});
        const glm::vec3 side = unit_or(glm::cross(way, {0, 1, 0}), {1, 0, 0}), above = glm::cross(side, way);
        const glm::vec3 point =
            a + (place - float(i)) * (b - a) + std::max(0.f, along - 0.999f) * limb.length_m * way +
            limb.length_m * (wide * float(p_.layer_width) * sideways * side + float(p_.layer_depth) * depth * above);
        if (relative_distance(point) < 1.1f && point.y > 0.01f * height_m &&
            random.uniform() < 0.1f + 0.9f * std::pow(along, float(p_.crown_shell)))
            points.push_back(point);
    }
}

std::vector<glm::vec3> Crown::attractors(int count, const std::vector<Limb>& limbs) const {
    Random random(p_.seed, streams::attractors);
    std::vector<glm::vec3> points;
    const double layered = limbs.empty() ? 0 : p_.crown_layers, rest = count * (1 - layered);
    draw_points(points, std::size_t(std::lround(rest * (1 - p_.crown_clumping))), random);
    draw_in_clumps(points, std::size_t(std::lround(rest)), random);
    draw_in_layers(points, std::size_t(count), limbs, random);
    while (points.size() < std::size_t(count)) // a crown too thin to hit by chance
        points.emplace_back(0, random.uniform(base_m, height_m), 0);
    return points;
}

} // namespace kokage

#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/streams.h"
#include "trees/growth/wood_graph.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// How an axis wanders along its course.
struct Wander {
    float bend_rad;        ///< how sharply it turns at a knee
    float knee_distance_m; ///< from knee to knee
};

/// A place on a course, `share` of the way along; straight on beyond its end.
glm::vec3 place_on(const std::vector<glm::vec3>& course, float share) {
    const float place = share * float(course.size() - 1);
    const std::size_t i = std::min(std::size_t(place), course.size() - 2);
    return course[i] + (place - float(i)) * (course[i + 1] - course[i]);
}

/// Appends steps along a course that wander: at every knee the axis turns off, then is drawn back.
void grow_axis(std::vector<WoodNode>& nodes, std::int32_t from, std::int32_t axis, const Limb& limb, float step,
               const Wander& wander, float bare_share, Random& random) {
    glm::vec3 position = nodes[std::size_t(from)].position;
    glm::vec3 direction = unit_or(limb.course[1] - limb.course[0], {0, 1, 0});
    const float lowest = 0.3f * position.y, way = std::max(limb.length_m, step);
    const float drawn_back = std::min(1.f, 1.05f * step / wander.knee_distance_m);
    const float ahead = std::max(2 * step, 0.8f * wander.knee_distance_m) / way;
    float since_knee = 0, next_knee = wander.knee_distance_m * random.uniform(0.4f, 1.f), grown = 0;
    float azimuth = random.uniform(0.f, 2 * kPi);
    std::int32_t parent = from;
    while (grown < way) {
        direction =
            unit_or(direction + drawn_back * unit_or(place_on(limb.course, grown / way + ahead) - position, direction),
                    direction);
        since_knee += step;
        if (since_knee >= next_knee) {
            since_knee = 0;
            next_knee = wander.knee_distance_m * random.uniform(0.6f, 1.4f);
            azimuth += kPi + random.uniform(-1.1f, 1.1f); // knees alternate sides
            direction = tilted(direction, wander.bend_rad * random.uniform(0.5f, 1.f), azimuth);
        }
        const float here = std::min(step, way - grown);
        if (here < 0.25f * step && grown > 0)
            break;
        position += here * direction;
        position.y = std::max(position.y, lowest);
        grown += here;
        nodes.push_back({position, parent, axis, grown >= bare_share * way});
        parent = std::int32_t(nodes.size()) - 1;
    }
}

/// A limb's direction in space, turning up by `bend` on its first `bend_over_m` metres and a little beyond.
struct LimbCourse {
    float azimuth = 0, elevation = 0, bend = 0, bend_over_m = 1;

    glm::vec3 direction(float at_m) const {
        const float e = elevation + bend * std::min(at_m / bend_over_m, 1.3f);
        return {std::cos(e) * std::cos(azimuth), std::sin(e), std::cos(e) * std::sin(azimuth)};
    }
};

/// How far a course goes until it leaves the crown; 0 if it never enters.
float distance_to_outline(const Crown& crown, const glm::vec3& from, const LimbCourse& course) {
    constexpr int pieces = 96, halvings = 5;
    const float piece = 2 * (crown.radius_m + crown.height_m) / float(pieces);
    bool is_inside = crown.relative_distance(from) <= 1;
    glm::vec3 place = from;
    for (int i = 0; i < pieces; ++i) {
        const glm::vec3 way = course.direction(piece * (float(i) + 0.5f));
        if (crown.relative_distance(place + piece * way) <= 1) {
            is_inside = true;
        } else if (is_inside) {
            float low = 0, high = piece;
            for (int k = 0; k < halvings; ++k) {
                const float middle = 0.5f * (low + high);
                (crown.relative_distance(place + middle * way) <= 1 ? low : high) = middle;
            }
            return piece * float(i) + low;
        }
        place += piece * way;
    }
    return is_inside ? piece * float(pieces) : 0.f;
}

/// The course of a limb as far as `share` of the way to the crown's outline; without points if that is less than a
/// step.
Limb plan_limb(const Crown& crown, const glm::vec3& from, LimbCourse course, float share, float step) {
    // The bend is spread over the way of a straight limb of the same mean elevation.
    const float straight =
        distance_to_outline(crown, from, {course.azimuth, course.elevation + 0.5f * course.bend, 0, 1});
    course.bend_over_m = std::max(straight, step);
    const float reach = distance_to_outline(crown, from, course);
    Limb limb;
    if (reach <= step)
        return limb;
    limb.length_m = reach * share;
    constexpr int pieces = 24;
    const float piece = limb.length_m / float(pieces);
    limb.course.push_back(from);
    for (int i = 0; i < pieces; ++i)
        limb.course.push_back(limb.course.back() + piece * course.direction(piece * (float(i) + 0.5f)));
    return limb;
}

/// The i-th limb's place on the trunk and its course.
struct LimbStart {
    float height_m;
    LimbCourse course;
};

LimbStart start_of_limb(const GrowthParameters& p, int i, float trunk_height_m, Random& random) {
    const float low = float(std::min(p.limb_first, p.trunk_reach)) * trunk_height_m;
    const float high = std::max(low, float(std::min(p.limb_last, p.trunk_reach)) * trunk_height_m);
    const int whorl = i / p.limb_whorl, whorls = (p.limbs + p.limb_whorl - 1) / p.limb_whorl;
    const float rank = whorls > 1 ? float(whorl) / float(whorls - 1) : 0.5f;
    // Limbs of one whorl leave the trunk at about the same height.
    Random whorl_random(p.seed, streams::of(streams::limb, (1u << 20) + std::uint64_t(whorl)));
    const float shift = p.limb_whorl == 1 ? random.uniform(-0.5f, 0.5f)
                                          : whorl_random.uniform(-0.3f, 0.3f) + random.uniform(-0.06f, 0.06f);
    LimbStart start;
    start.height_m = low + (high - low) * std::clamp(rank + shift / float(whorls), 0.f, 1.f);
    start.course.elevation =
        radians(p.limb_elevation_low + (p.limb_elevation_high - p.limb_elevation_low) * double(rank)) +
        random.uniform(-0.15f, 0.15f);
    start.course.azimuth = radians(p.limb_divergence) * float(whorl) +
                           2 * kPi * float(i % p.limb_whorl) / float(p.limb_whorl) + random.uniform(-0.35f, 0.35f) +
                           float(p.seed % 1024) * 0.7f;
    start.course.bend = radians(p.limb_bend);
    return start;
}

/// The node of the trunk nearest in height; the trunk's are the first `count` nodes.
std::int32_t trunk_node_at(const std::vector<WoodNode>& nodes, std::size_t count, float height_m) {
    std::size_t nearest = 0;
    for (std::size_t n = 1; n < count; ++n)
        if (std::abs(nodes[n].position.y - height_m) < std::abs(nodes[nearest].position.y - height_m))
            nearest = n;
    return std::int32_t(nearest);
}

} // namespace

Scaffold grow_scaffold(const GrowthParameters& p, const Crown& crown, float step) {
    Scaffold result;
    std::vector<WoodNode>& nodes = result.nodes;
    nodes.push_back({{0, 0, 0}, -1, 0, false});
    Random trunk_random(p.seed, streams::trunk);
    const Limb trunk{{{0, 0, 0}, {0, crown.height_m * float(p.trunk_reach), 0}}, crown.height_m * float(p.trunk_reach)};
    grow_axis(nodes, 0, 0, trunk, step, {radians(p.trunk_wiggle), std::max(step, 0.16f * crown.height_m)},
              std::min(0.95f, 1.3f * float(std::min(p.limb_first, p.trunk_reach) / p.trunk_reach)), trunk_random);
    const std::size_t trunk_end = nodes.size();
    for (int i = 0; i < p.limbs; ++i) {
        Random random(p.seed, streams::of(streams::limb, std::uint64_t(i)));
        const LimbStart start = start_of_limb(p, i, crown.height_m, random);
        const std::int32_t origin = trunk_node_at(nodes, trunk_end, start.height_m);
        const Limb limb = plan_limb(crown, nodes[std::size_t(origin)].position, start.course,
                                    float(p.limb_reach) * random.uniform(0.85f, 1.1f), step);
        if (limb.course.empty())
            continue;
        grow_axis(nodes, origin, i + 1, limb, step, {radians(p.limb_zigzag), std::max(step, 0.17f * crown.radius_m)},
                  float(p.limb_bare), random);
        result.limbs.push_back(limb);
    }
    return result;
}

} // namespace kokage

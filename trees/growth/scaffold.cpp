#include "common/services/random.h"
#include "trees/growth/directions.h"
#include "trees/growth/streams.h"
#include "trees/growth/wood_graph.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Appends steps from `from` towards `target` that wander: at every knee the course turns by up to `bend`, then is
/// drawn back.
void grow_axis(std::vector<WoodNode>& nodes, std::int32_t from, std::int32_t axis, glm::vec3 direction,
               const glm::vec3& target, float length, float step, float bend, float knee_distance, float bare_share,
               Random& random) {
    glm::vec3 position = nodes[std::size_t(from)].position;
    const glm::vec3 start = position;
    const float way = std::max(length, step);
    float since_knee = 0, next_knee = knee_distance * random.uniform(0.4f, 1.f), grown = 0;
    float azimuth = random.uniform(0.f, 2 * kPi);
    std::int32_t parent = from;
    while (grown < way) {
        const float rest = way - grown;
        // Towards the target, seen from where the axis is now; near its end it runs out in its own direction.
        const glm::vec3 course = unit_or(target - position, direction);
        direction = unit_or(direction + std::min(1.f, 0.35f * step / knee_distance * 3.f) * course, direction);
        since_knee += step;
        if (since_knee >= next_knee) {
            since_knee = 0;
            next_knee = knee_distance * random.uniform(0.6f, 1.4f);
            azimuth += kPi + random.uniform(-1.1f, 1.1f); // knees alternate sides
            direction = tilted(direction, bend * random.uniform(0.5f, 1.f), azimuth);
        }
        const float here = std::min(step, rest);
        if (here < 0.25f * step && grown > 0)
            break;
        position += here * direction;
        position.y = std::max(position.y, start.y * 0.3f);
        grown += here;
        nodes.push_back({position, parent, axis, grown >= bare_share * way});
        parent = std::int32_t(nodes.size()) - 1;
    }
}

/// How far a ray from inside the crown goes before it leaves it.
float distance_to_outline(const Crown& crown, const glm::vec3& from, const glm::vec3& direction) {
    const float far = 2 * (crown.radius_m + crown.height_m);
    float inside = 0;
    for (int i = 1; i <= 96; ++i) {
        const float t = far * float(i) / 96.f;
        if (crown.relative_distance(from + t * direction) <= 1)
            inside = t;
    }
    return inside;
}

} // namespace

std::vector<WoodNode> grow_scaffold(const GrowthParameters& p, const Crown& crown, float step) {
    std::vector<WoodNode> nodes;
    nodes.push_back({{0, 0, 0}, -1, 0, false});
    Random trunk_random(p.seed, streams::trunk);
    const float trunk_length = crown.height_m * float(p.trunk_reach);
    const float limb_first = float(std::min(p.limb_first, p.trunk_reach) * crown.height_m);
    const float limb_last = std::max(limb_first, float(std::min(p.limb_last, p.trunk_reach) * crown.height_m));
    grow_axis(nodes, 0, 0, {0, 1, 0}, {0, crown.height_m, 0}, trunk_length, step, radians(p.trunk_wiggle),
              std::max(step, 0.16f * crown.height_m), std::min(0.95f, limb_first / trunk_length * 1.3f), trunk_random);
    const std::size_t trunk_end = nodes.size();
    for (int i = 0; i < p.limbs; ++i) {
        Random random(p.seed, streams::of(streams::limb, std::uint64_t(i)));
        const float rank = p.limbs > 1 ? float(i) / float(p.limbs - 1) : 0.5f;
        const float height = limb_first + (limb_last - limb_first) *
                                              std::clamp(rank + random.uniform(-0.5f, 0.5f) / float(p.limbs), 0.f, 1.f);
        std::size_t origin = 0;
        for (std::size_t n = 1; n < trunk_end; ++n)
            if (std::abs(nodes[n].position.y - height) < std::abs(nodes[origin].position.y - height))
                origin = n;
        const float elevation =
            radians(p.limb_elevation_low + (p.limb_elevation_high - p.limb_elevation_low) * double(rank)) +
            random.uniform(-0.15f, 0.15f);
        const float azimuth = 2.39996323f * float(i) + random.uniform(-0.35f, 0.35f) + float(p.seed % 1024) * 0.7f;
        const glm::vec3 course{std::cos(elevation) * std::cos(azimuth), std::sin(elevation),
                               std::cos(elevation) * std::sin(azimuth)};
        const glm::vec3 from = nodes[origin].position;
        const float reach = distance_to_outline(crown, from, course);
        if (reach <= step)
            continue;
        const glm::vec3 first = unit_or(course + glm::vec3(0, random.uniform(0.f, 0.35f), 0), course);
        grow_axis(nodes, std::int32_t(origin), i + 1, first, from + reach * course,
                  reach * float(p.limb_reach) * random.uniform(0.85f, 1.1f), step, radians(p.limb_zigzag),
                  std::max(step, 0.17f * crown.radius_m), 0.22f, random);
    }
    return nodes;
}

} // namespace kokage

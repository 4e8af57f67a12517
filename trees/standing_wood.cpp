#include "trees/standing_wood.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

constexpr float kOnAxis = 0.15f; // of the wood's radius: rings of rough bark have their middles that far off

/// Of a branch's axis, what is nearest to a place.
AxisPlace nearest_on(const Skeleton& skeleton, std::uint32_t branch, const glm::vec3& place) {
    std::vector<AxisSamples::Sample> nodes;
    for (const Branch::Node& node : skeleton.branches[branch].nodes)
        nodes.push_back({node.position, node.radius_m, branch});
    AxisPlace best = nearest_around(nodes, 0, place);
    for (std::size_t i = 1; i < nodes.size(); ++i)
        if (const AxisPlace next = nearest_around(nodes, i, place); next.distance < best.distance)
            best = next;
    return best;
}

} // namespace

void StandingWood::add(const Skeleton& skeleton, std::size_t first_branch) {
    skeleton_ = &skeleton;
    const std::vector<AxisSamples::Sample> samples = sample_axes(skeleton, first_branch).samples;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const AxisSamples::Sample& sample = samples[i];
        const Branch& branch = skeleton.branches[sample.branch];
        if (i > 0 && samples[i - 1].branch == sample.branch)
            add_piece(samples[i - 1], sample);
        else if (branch.nodes.size() == 1)
            add_piece(sample, sample);
        if (branch.parent >= 0) {
            const Branch::Node& start = branch.nodes[0];
            const float parent_radius = nearest_on(skeleton, std::uint32_t(branch.parent), start.position).radius_m;
            if (glm::distance(start.position, sample.position) <= std::max(parent_radius, start.radius_m))
                continue;
        }
        outer_.add(sample);
    }
}

void StandingWood::add_piece(const AxisSamples::Sample& a, const AxisSamples::Sample& b) {
    const float radius = std::max(a.radius_m, b.radius_m); // tips may have none
    if (radius > 0)
        by_size_[{std::ilogb(radius), std::ilogb(std::max(glm::distance(a.position, b.position), 0.5f * radius))}].add(
            a, b);
}

AxisPlace StandingWood::bearer_of(AxisPlace axis, const glm::vec3& place) const {
    while (true) {
        const Branch& branch = skeleton_->branches[axis.branch];
        if (branch.parent < 0 || glm::distance(branch.nodes[0].position, place) > branch.nodes[0].radius_m)
            return axis;
        axis = nearest_on(*skeleton_, std::uint32_t(branch.parent), place);
    }
}

WoodHold StandingWood::on_axis(const glm::vec3& place) const {
    WoodHold hold;
    float least = kOnAxis;
    for (const auto& [magnitudes, pieces] : by_size_) {
        const float radius = std::ldexp(1.f, magnitudes[0] + 1), length = std::ldexp(1.f, magnitudes[1] + 1);
        for (const std::uint32_t piece : pieces.middles.within(place, kOnAxis * radius + 0.5f * length)) {
            const AxisPlace axis = nearest_on_piece(pieces.ends[piece][0], pieces.ends[piece][1], place);
            if (axis.distance <= least * axis.radius_m) {
                hold.axis = axis;
                least = axis.radius_m > 0 ? axis.distance / axis.radius_m : 0.f;
            }
        }
    }
    if (!hold.axis.found)
        return hold;
    hold.axis = bearer_of(hold.axis, place);
    hold.depth = hold.axis.distance - hold.axis.radius_m;
    hold.touches = true;
    return hold;
}

WoodHold StandingWood::nearest(const glm::vec3& place, float reach) const {
    if (const WoodHold hold = on_axis(place); hold.touches)
        return hold;
    WoodHold hold;
    hold.axis = outer_.nearest(place);
    if (!hold.axis.found)
        return hold;
    hold.depth = hold.axis.distance - hold.axis.radius_m;
    hold.touches = hold.depth <= reach;
    return hold;
}

} // namespace kokage

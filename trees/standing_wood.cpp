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
    for (const AxisSamples::Sample& sample : sample_axes(skeleton, first_branch).samples) {
        const Branch& branch = skeleton.branches[sample.branch];
        const float radius = std::max(sample.radius_m, 0.25f * branch.nodes[0].radius_m); // tips may have none
        if (radius > 0)
            by_radius_[std::ilogb(radius)].add(sample);
        if (branch.parent >= 0) {
            const Branch::Node& start = branch.nodes[0];
            const float parent_radius = nearest_on(skeleton, std::uint32_t(branch.parent), start.position).radius_m;
            if (glm::distance(start.position, sample.position) <= std::max(parent_radius, start.radius_m))
                continue;
        }
        outer_.add(sample);
    }
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
    for (const auto& [magnitude, wood] : by_radius_) {
        const AxisPlace axis = wood.nearest(place);
        if (axis.distance <= least * axis.radius_m) {
            hold.axis = axis;
            least = axis.radius_m > 0 ? axis.distance / axis.radius_m : 0.f;
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

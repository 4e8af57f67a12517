#include "foliage/light_map_placement.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {

namespace {

constexpr double kSphereShare = 0.95;
constexpr double kSamePlace = 1e-5; // of the extent of all branching points: files round positions

/// The last order that bears leaves; without leaves, the last order.
int find_last_generation(const Tree& tree) {
    const auto& branches = tree.skeleton.branches;
    int leafy = -1, any = 0;
    for (const Leaf& leaf : tree.leaves)
        if (leaf.branch >= 0 && std::size_t(leaf.branch) < branches.size())
            leafy = std::max(leafy, branches[std::size_t(leaf.branch)].order);
    for (const Branch& branch : branches)
        any = std::max(any, branch.order);
    return leafy >= 0 ? leafy : any;
}

std::vector<std::int32_t> find_candidates(const Skeleton& skeleton, int last_generation) {
    std::vector<std::int32_t> candidates;
    for (std::size_t i = 0; i < skeleton.branches.size(); ++i) {
        const Branch& branch = skeleton.branches[i];
        const int g = branch.order;
        if (g >= 1 && !branch.nodes.empty() && (g == 1 || g == last_generation - 1 || g == last_generation))
            candidates.push_back(std::int32_t(i));
    }
    return candidates;
}

const glm::vec3& branching_point(const Skeleton& skeleton, std::int32_t branch) {
    return skeleton.branches[std::size_t(branch)].nodes.front().position;
}

/// Index in `candidates` of the lowest branching point of generation 1; of any generation if there is none of the
/// first.
std::size_t find_start(const Skeleton& skeleton, const std::vector<std::int32_t>& candidates) {
    std::size_t start = 0;
    bool start_is_first_generation = false;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        const bool first_generation = skeleton.branches[std::size_t(candidates[i])].order == 1;
        const bool lower = branching_point(skeleton, candidates[i]).y < branching_point(skeleton, candidates[start]).y;
        if ((first_generation && !start_is_first_generation) ||
            (first_generation == start_is_first_generation && lower)) {
            start = i;
            start_is_first_generation = first_generation;
        }
    }
    return start;
}

std::vector<std::int32_t> sample_farthest_points(const Skeleton& skeleton, const std::vector<std::int32_t>& candidates,
                                                 std::size_t count) {
    std::vector<std::int32_t> picked;
    std::vector<double> distance2(candidates.size(), std::numeric_limits<double>::infinity());
    std::size_t next = find_start(skeleton, candidates);
    glm::dvec3 low(branching_point(skeleton, candidates[0])), high = low;
    for (const std::int32_t candidate : candidates) {
        low = glm::min(low, glm::dvec3(branching_point(skeleton, candidate)));
        high = glm::max(high, glm::dvec3(branching_point(skeleton, candidate)));
    }
    const double same_place = kSamePlace * glm::distance(low, high);
    while (picked.size() < count) {
        picked.push_back(candidates[next]);
        const glm::dvec3 latest = branching_point(skeleton, candidates[next]);
        std::size_t farthest = 0;
        for (std::size_t i = 0; i < candidates.size(); ++i) {
            const glm::dvec3 to = glm::dvec3(branching_point(skeleton, candidates[i])) - latest;
            distance2[i] = std::min(distance2[i], glm::dot(to, to));
            if (distance2[i] > distance2[farthest]) // strictly: ties go to the lower index
                farthest = i;
        }
        if (!(distance2[farthest] > same_place * same_place))
            break;
        next = farthest;
    }
    return picked;
}

/// Radius of the parent's wood where it passes closest to the point.
float wood_radius_near(const Branch& branch, const glm::vec3& point) {
    float best2 = std::numeric_limits<float>::infinity(), radius = 0;
    for (std::size_t i = 0; i < branch.nodes.size(); ++i) {
        const Branch::Node& a = branch.nodes[i];
        const Branch::Node& b = branch.nodes[std::min(i + 1, branch.nodes.size() - 1)];
        const glm::vec3 along = b.position - a.position, to = point - a.position;
        const float length2 = glm::dot(along, along);
        const float t = length2 > 0 ? std::clamp(glm::dot(to, along) / length2, 0.f, 1.f) : 0.f;
        const glm::vec3 off = to - t * along;
        if (const float d2 = glm::dot(off, off); d2 < best2) {
            best2 = d2;
            radius = a.radius_m + t * (b.radius_m - a.radius_m);
        }
    }
    return radius;
}

LightMapPlace place_at_branch(const Skeleton& skeleton, std::int32_t index) {
    const Branch& branch = skeleton.branches[std::size_t(index)];
    LightMapPlace place;
    place.position = branch.nodes.front().position;
    place.generation = branch.order;
    place.branch = index;
    place.clearance_m = branch.nodes.front().radius_m;
    if (branch.parent >= 0)
        place.clearance_m = std::max(place.clearance_m,
                                     wood_radius_near(skeleton.branches[std::size_t(branch.parent)], place.position));
    return place;
}

/// Sphere radii: each leaf counts for every picked branch between itself and the root.
void set_radii(const Tree& tree, std::vector<LightMapPlace>& places) {
    const auto& branches = tree.skeleton.branches;
    std::vector<std::int32_t> place_of(branches.size(), -1);
    for (std::size_t i = 0; i < places.size(); ++i)
        place_of[std::size_t(places[i].branch)] = std::int32_t(i);
    std::vector<std::vector<float>> distances(places.size());
    for (const Leaf& leaf : tree.leaves) {
        if (leaf.branch < 0 || std::size_t(leaf.branch) >= branches.size())
            continue;
        for (std::int32_t b = leaf.branch; b >= 0; b = branches[std::size_t(b)].parent)
            if (const std::int32_t place = place_of[std::size_t(b)]; place >= 0)
                distances[std::size_t(place)].push_back(
                    glm::distance(leaf.centre, places[std::size_t(place)].position));
    }
    for (std::size_t i = 0; i < places.size(); ++i)
        places[i].radius_m = percentile(std::move(distances[i]), kSphereShare);
}

/// For trees whose branching gives no place: the centre of the leaves, else of the wood, else of the meshes.
std::vector<LightMapPlace> place_at_centre(const Tree& tree) {
    glm::dvec3 sum{0.0};
    std::size_t count = 0;
    const auto add = [&](const glm::vec3& position) {
        sum += glm::dvec3(position);
        ++count;
    };
    for (const Leaf& leaf : tree.leaves)
        add(leaf.centre);
    if (count == 0)
        for (const Branch& branch : tree.skeleton.branches)
            for (const Branch::Node& node : branch.nodes)
                add(node.position);
    if (count == 0)
        for (const TreePart& part : tree.parts)
            for (const glm::vec3& position : part.positions)
                add(position);
    if (count == 0)
        return {};
    LightMapPlace place;
    place.position = glm::vec3(sum / double(count));
    std::vector<float> distances;
    for (const Leaf& leaf : tree.leaves)
        distances.push_back(glm::distance(leaf.centre, place.position));
    place.radius_m = percentile(std::move(distances), kSphereShare);
    return {place};
}

} // namespace

float percentile(std::vector<float> values, double share) {
    if (values.empty())
        return 0;
    const double rank = std::ceil(share * double(values.size()));
    const std::size_t index = std::size_t(std::clamp(rank, 1.0, double(values.size()))) - 1;
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(index), values.end());
    return values[index];
}

LightMapPlacement place_light_maps(const Tree& tree, int count) {
    if (count < 1)
        throw InputError("the number of light maps is " + std::to_string(count) + "; it must be at least 1 (--maps)");
    LightMapPlacement placement;
    placement.last_generation = find_last_generation(tree);
    const std::vector<std::int32_t> candidates = find_candidates(tree.skeleton, placement.last_generation);
    placement.candidates = candidates.size();
    if (candidates.empty()) {
        placement.places = place_at_centre(tree);
        if (!placement.places.empty())
            placement.note = "the tree has no branching points: one light map stands at the centre of its " +
                             std::string(tree.leaves.empty() ? "wood" : "leaves");
        return placement;
    }
    for (std::int32_t branch : sample_farthest_points(tree.skeleton, candidates, std::size_t(count)))
        placement.places.push_back(place_at_branch(tree.skeleton, branch));
    set_radii(tree, placement.places);
    if (!tree.branching_known)
        placement.note = "light maps stand at branching points that were inferred from bark and leaf clusters";
    return placement;
}

} // namespace kokage

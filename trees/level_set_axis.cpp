#include "trees/level_set_axis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kokage {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// A set of vertices that becomes a point of the axis.
struct LevelSet {
    int level = 0;
    std::vector<std::uint32_t> members;
    std::vector<std::uint32_t> linked; ///< other sets that share an edge with it
    std::uint32_t joined_to = kNone;

    void take(LevelSet& other) {
        members.insert(members.end(), other.members.begin(), other.members.end());
        linked.insert(linked.end(), other.linked.begin(), other.linked.end());
        other.members.clear();
        other.linked.clear();
    }
};

std::uint32_t find_set(std::vector<LevelSet>& sets, std::uint32_t set) {
    while (sets[set].joined_to != kNone) {
        if (sets[sets[set].joined_to].joined_to != kNone)
            sets[set].joined_to = sets[sets[set].joined_to].joined_to;
        set = sets[set].joined_to;
    }
    return set;
}

/// Joins the sets of one level that a set of a higher level touches, from the highest level down: what goes apart and
/// comes together again on the way to the tip is one limb.
void close_loops(std::vector<LevelSet>& sets) {
    std::vector<std::uint32_t> order(sets.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return sets[a].level > sets[b].level; });
    for (const std::uint32_t index : order) {
        if (sets[index].joined_to != kNone)
            continue;
        std::vector<std::pair<int, std::uint32_t>> lower;
        for (const std::uint32_t link : sets[index].linked) {
            const std::uint32_t other = find_set(sets, link);
            if (sets[other].level < sets[index].level)
                lower.emplace_back(sets[other].level, other);
        }
        std::sort(lower.begin(), lower.end());
        for (std::size_t i = 1; i < lower.size(); ++i) {
            const std::uint32_t a = find_set(sets, lower[i - 1].second), b = find_set(sets, lower[i].second);
            if (lower[i - 1].first != lower[i].first || a == b)
                continue;
            sets[a].take(sets[b]);
            sets[b].joined_to = a;
        }
    }
}

/// A tree of sets while it is simplified.
struct Knot {
    glm::dvec3 sum{0.0};
    std::vector<std::uint32_t> members;
    std::vector<std::uint32_t> children;
    std::uint32_t parent = kNone;
    bool gone = false;

    glm::dvec3 centre() const { return sum / double(members.size()); }
};

double radius_of(const Knot& knot, std::span<const glm::vec3> positions) {
    const glm::dvec3 centre = knot.centre();
    double sum = 0;
    for (const std::uint32_t v : knot.members)
        sum += glm::distance(glm::dvec3(positions[v]), centre);
    return sum / double(knot.members.size());
}

/// Neighbouring sets nearer to each other than the wood is thick become one, from the tips down.
void join_near_knots(std::vector<Knot>& knots, const std::vector<std::uint32_t>& order,
                     std::span<const glm::vec3> positions) {
    for (std::size_t i = order.size(); i-- > 1;) {
        const std::uint32_t index = order[i];
        Knot& knot = knots[index];
        Knot& parent = knots[knot.parent];
        const double radius = std::max(radius_of(knot, positions), radius_of(parent, positions));
        const bool chain = parent.children.size() == 1, spur = knot.children.empty();
        if ((!chain && !spur) || glm::distance(knot.centre(), parent.centre()) >= radius)
            continue;
        parent.sum += knot.sum;
        parent.members.insert(parent.members.end(), knot.members.begin(), knot.members.end());
        std::erase(parent.children, index);
        for (const std::uint32_t child : knot.children) {
            knots[child].parent = knot.parent;
            parent.children.push_back(child);
        }
        knot.gone = true;
    }
}

/// A set for each connected part of a level.
std::vector<LevelSet> make_level_sets(const LevelSetAxis& mesh, std::span<const std::uint32_t> vertices, float width) {
    const std::span<std::uint32_t> set_of = mesh.set_of;
    const auto level = [&](std::uint32_t v) { return width > 0 ? int(mesh.distance[v] / width) : 0; };
    std::vector<LevelSet> sets;
    for (const std::uint32_t v : vertices)
        set_of[v] = kNone;
    for (const std::uint32_t start : vertices) {
        if (set_of[start] != kNone)
            continue;
        const std::uint32_t index = std::uint32_t(sets.size());
        LevelSet set;
        set.level = level(start);
        set.members.push_back(start);
        set_of[start] = index;
        for (std::size_t i = 0; i < set.members.size(); ++i)
            for (const std::uint32_t other : mesh.neighbours.of(set.members[i]))
                if (set_of[other] == kNone && level(other) == set.level) {
                    set_of[other] = index;
                    set.members.push_back(other);
                }
        sets.push_back(std::move(set));
    }
    for (const std::uint32_t v : vertices)
        for (const std::uint32_t other : mesh.neighbours.of(v))
            if (set_of[other] != set_of[v])
                sets[set_of[v]].linked.push_back(set_of[other]);
    return sets;
}

/// Each set hangs on the highest one below it (towards the tip). Returns the neighbours in that tree.
std::vector<std::vector<std::uint32_t>> hang_on_next_lower(std::vector<LevelSet>& sets) {
    std::vector<std::vector<std::uint32_t>> links(sets.size());
    for (std::uint32_t i = 0; i < sets.size(); ++i) {
        if (sets[i].joined_to != kNone)
            continue;
        std::uint32_t below = kNone;
        for (const std::uint32_t link : sets[i].linked) {
            const std::uint32_t other = find_set(sets, link);
            if (sets[other].level < sets[i].level && (below == kNone || sets[other].level > sets[below].level))
                below = other;
        }
        if (below != kNone) {
            links[i].push_back(below);
            links[below].push_back(i);
        }
    }
    return links;
}

/// The same tree, but from its root at the base; `order` begins there, parents before children.
std::vector<Knot> knots_from(std::uint32_t root, const std::vector<LevelSet>& sets,
                             const std::vector<std::vector<std::uint32_t>>& links, std::span<const glm::vec3> positions,
                             std::vector<std::uint32_t>& order) {
    std::vector<Knot> knots(sets.size());
    order = {root};
    for (std::size_t i = 0; i < order.size(); ++i) {
        Knot& knot = knots[order[i]];
        knot.members = sets[order[i]].members;
        for (const std::uint32_t v : knot.members)
            knot.sum += glm::dvec3(positions[v]);
        for (const std::uint32_t other : links[order[i]])
            if (other != knot.parent) {
                knots[other].parent = order[i];
                knot.children.push_back(other);
                order.push_back(other);
            }
    }
    return knots;
}

std::vector<AxisNode> axis_nodes(const std::vector<Knot>& knots, const std::vector<std::uint32_t>& order,
                                 std::span<const glm::vec3> positions) {
    std::vector<AxisNode> nodes;
    std::vector<std::uint32_t> number(knots.size(), kNone);
    for (const std::uint32_t index : order) {
        const Knot& knot = knots[index];
        if (knot.gone)
            continue;
        number[index] = std::uint32_t(nodes.size());
        AxisNode node;
        node.position = glm::vec3(knot.centre());
        node.radius_m = float(radius_of(knot, positions));
        if (!nodes.empty()) {
            node.parent = number[knot.parent];
            nodes[node.parent].children.push_back(number[index]);
        }
        nodes.push_back(std::move(node));
    }
    for (std::uint32_t i = std::uint32_t(nodes.size()); i-- > 1;) {
        AxisNode& parent = nodes[nodes[i].parent];
        parent.reach = std::max(parent.reach, nodes[i].reach + glm::distance(parent.position, nodes[i].position));
    }
    return nodes;
}

} // namespace

std::vector<AxisNode> LevelSetAxis::tree(std::span<const std::uint32_t> vertices, float width,
                                         std::uint32_t base) const {
    std::vector<LevelSet> sets = make_level_sets(*this, vertices, width);
    close_loops(sets);
    const std::vector<std::vector<std::uint32_t>> links = hang_on_next_lower(sets);
    std::vector<std::uint32_t> order;
    std::vector<Knot> knots = knots_from(find_set(sets, set_of[base]), sets, links, positions, order);
    join_near_knots(knots, order, positions);
    return axis_nodes(knots, order, positions);
}

} // namespace kokage

#include "trees/find_branching.h"

#include "common/services/count_text.h"
#include "common/services/parallel.h"
#include "trees/bark_skeleton.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr std::size_t kMaximumLeavesPerTwig = 64;

/// All bark in one triangle soup.
BarkSkeleton skeleton_of_bark(const Tree& tree) {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    for (const TreePart& part : tree.parts) {
        if (part.kind != TreePartKind::bark)
            continue;
        const auto first = std::uint32_t(positions.size());
        positions.insert(positions.end(), part.positions.begin(), part.positions.end());
        for (const glm::uvec3& t : part.triangles)
            triangles.push_back(t + first);
    }
    return skeleton_from_bark(positions, triangles);
}

struct Box {
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    void add(const glm::vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    glm::vec3 extent() const { return low.x <= high.x ? high - low : glm::vec3(0.f); }
};

/// A stem from the ground below the leaves to their middle, for a crown without any wood.
Branch imagined_trunk(const Tree& tree) {
    Box box;
    glm::dvec3 sum(0.0);
    for (const Leaf& leaf : tree.leaves) {
        box.add(leaf.centre);
        sum += glm::dvec3(leaf.centre);
    }
    const glm::vec3 middle = tree.leaves.empty() ? glm::vec3(0.f) : glm::vec3(sum / double(tree.leaves.size()));
    const float ground = tree.leaves.empty() ? 0.f : std::min(box.low.y, middle.y);
    Branch trunk;
    trunk.nodes = {{{middle.x, ground, middle.z}, 0.f}, {middle, 0.f}};
    return trunk;
}

glm::vec3 centroid(const Tree& tree, std::span<const std::uint32_t> leaves) {
    glm::dvec3 sum(0.0);
    for (const std::uint32_t leaf : leaves)
        sum += glm::dvec3(tree.leaves[leaf].centre);
    return glm::vec3(sum / double(leaves.size()));
}

/// Halves a set of leaves at the median of its longest extent until each cluster's half diagonal is at most `radius`.
void cut_into_clusters(const Tree& tree, std::span<std::uint32_t> leaves, float radius,
                       std::vector<std::span<std::uint32_t>>& clusters) {
    Box box;
    for (const std::uint32_t leaf : leaves)
        box.add(tree.leaves[leaf].centre);
    const glm::vec3 extent = box.extent();
    if (leaves.size() < 2 || 0.5f * glm::length(extent) <= radius) {
        clusters.push_back(leaves);
        return;
    }
    const std::size_t axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const float ca = tree.leaves[a].centre[axis], cb = tree.leaves[b].centre[axis];
        return ca != cb ? ca < cb : a < b;
    };
    const std::size_t half = leaves.size() / 2;
    std::nth_element(leaves.begin(), leaves.begin() + std::ptrdiff_t(half), leaves.end(), before);
    cut_into_clusters(tree, leaves.first(half), radius, clusters);
    cut_into_clusters(tree, leaves.subspan(half), radius, clusters);
}

/// Adds twigs that lead from a branch to clusters of leaves, in two generations.
class TwigMaker {
  public:
    TwigMaker(Tree& tree, float crown) : tree_(tree), crown_(crown) {}
    std::size_t twigs = 0;

    void add(std::uint32_t branch, std::vector<std::uint32_t>& leaves) {
        std::vector<std::span<std::uint32_t>> limbs;
        cut_into_clusters(tree_, leaves, 0.5f * crown_, limbs);
        for (const std::span<std::uint32_t> limb : limbs) {
            const std::int32_t index = twig(std::int32_t(branch), nearest_node(branch, limb), centroid(tree_, limb));
            std::vector<std::span<std::uint32_t>> tips;
            cut_into_clusters(tree_, limb, 0.2f * crown_, tips);
            for (const std::span<std::uint32_t> tip : tips) {
                const std::int32_t bearer =
                    tips.size() == 1
                        ? index
                        : twig(index, tree_.skeleton.branches[std::size_t(index)].nodes.back(), centroid(tree_, tip));
                for (const std::uint32_t leaf : tip)
                    tree_.leaves[leaf].branch = bearer;
            }
        }
    }

  private:
    Branch::Node nearest_node(std::uint32_t branch, std::span<const std::uint32_t> leaves) const {
        const glm::vec3 middle = centroid(tree_, leaves);
        const std::vector<Branch::Node>& nodes = tree_.skeleton.branches[branch].nodes;
        return *std::min_element(nodes.begin(), nodes.end(), [&](const Branch::Node& a, const Branch::Node& b) {
            return glm::distance(a.position, middle) < glm::distance(b.position, middle);
        });
    }

    std::int32_t twig(std::int32_t parent, const Branch::Node& from, const glm::vec3& to) {
        Branch branch;
        branch.parent = parent;
        branch.order = tree_.skeleton.branches[std::size_t(parent)].order + 1;
        branch.nodes = {{from.position, 0.f}, {to, 0.f}};
        tree_.skeleton.branches.push_back(std::move(branch));
        ++twigs;
        return std::int32_t(tree_.skeleton.branches.size()) - 1;
    }

    Tree& tree_;
    float crown_;
};

/// The leaves of each branch, and each one's distance from wood.
struct Bearing {
    std::vector<std::vector<std::uint32_t>> leaves;
    std::vector<float> distance;
};

/// Where a leaf may hang on wood: its corners, and the middles of the edges of cards, which have no corner at their
/// foot.
struct LeafPoints {
    std::vector<std::uint32_t> first; ///< leaf count + 1
    std::vector<glm::vec3> points;
    std::span<const glm::vec3> of(std::size_t leaf) const {
        return std::span(points).subspan(first[leaf], first[leaf + 1] - first[leaf]);
    }
};

LeafPoints points_of_leaves(const Tree& tree) {
    constexpr std::uint32_t kCardTriangles = 4;
    std::vector<std::uint32_t> triangles(tree.leaves.size(), 0);
    for (const TreePart& part : tree.parts)
        if (part.kind == TreePartKind::foliage)
            for (const std::uint32_t leaf : part.triangle_patch)
                ++triangles[leaf];
    LeafPoints result;
    result.first.assign(tree.leaves.size() + 1, 0);
    for (std::size_t leaf = 0; leaf < triangles.size(); ++leaf)
        result.first[leaf + 1] = result.first[leaf] + triangles[leaf] * (triangles[leaf] <= kCardTriangles ? 6 : 3);
    result.points.resize(result.first.back());
    std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
    for (const TreePart& part : tree.parts) {
        if (part.kind != TreePartKind::foliage)
            continue;
        for (std::size_t t = 0; t < part.triangles.size(); ++t) {
            const std::uint32_t leaf = part.triangle_patch[t];
            for (int c = 0; c < 3; ++c) {
                const glm::vec3 &a = part.positions[part.triangles[t][c]],
                                &b = part.positions[part.triangles[t][(c + 1) % 3]];
                result.points[next[leaf]++] = a;
                if (triangles[leaf] <= kCardTriangles)
                    result.points[next[leaf]++] = 0.5f * (a + b);
            }
        }
    }
    return result;
}

/// The two points of a leaf that lie about farthest apart.
std::array<glm::vec3, 2> ends_of(std::span<const glm::vec3> points, const glm::vec3& centre) {
    const auto farthest_from = [&](const glm::vec3& place) {
        glm::vec3 farthest = place;
        for (const glm::vec3& point : points)
            if (glm::distance(point, place) > glm::distance(farthest, place))
                farthest = point;
        return farthest;
    };
    const glm::vec3 first = farthest_from(centre);
    return {first, farthest_from(first)};
}

/// Leaves hang by an end; by chance their other parts come near to wood as well.
float doubt(const glm::vec3& point, const std::array<glm::vec3, 2>& ends) {
    const float near_end = 0.3f * glm::distance(ends[0], ends[1]);
    return std::min(glm::distance(point, ends[0]), glm::distance(point, ends[1])) <= near_end ? 1.f : 3.f;
}

/// Gives each leaf to the branch that it hangs on: the one whose axis a point of the leaf touches; of leaves that touch
/// none, the one nearest to the leaf's centre.
Bearing assign_leaves(Tree& tree) {
    Bearing bearing;
    bearing.leaves.resize(tree.skeleton.branches.size());
    bearing.distance.resize(tree.leaves.size());
    const NearestAxis axes(tree.skeleton);
    const LeafPoints points = points_of_leaves(tree);
    parallel_blocks(tree.leaves.size(), 512, [&](std::size_t begin, std::size_t end) {
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
            const glm::vec3& centre = tree.leaves[leaf].centre;
            const AxisPlace nearest = axes.at(centre);
            AxisPlace hold = nearest; // where the leaf comes nearest to an axis, and so hangs
            float reach = 0, least = nearest.distance;
            const std::array<glm::vec3, 2> ends = ends_of(points.of(leaf), centre);
            for (const glm::vec3& point : points.of(leaf)) {
                reach = std::max(reach, glm::distance(point, centre));
                const AxisPlace place = axes.at(point);
                if (const float distance = place.distance * doubt(point, ends); distance < least) {
                    least = distance;
                    hold = place;
                }
            }
            const bool touches = hold.distance - hold.radius_m <= 0.25f * reach;
            tree.leaves[leaf].branch = std::int32_t((touches ? hold : nearest).branch);
            bearing.distance[leaf] = std::max(0.f, nearest.distance - nearest.radius_m);
        }
    });
    for (std::uint32_t leaf = 0; leaf < tree.leaves.size(); ++leaf)
        bearing.leaves[std::size_t(tree.leaves[leaf].branch)].push_back(leaf);
    return bearing;
}

float percentile_95(std::vector<float> values) {
    const std::size_t at = std::min(values.size() - 1, values.size() * 95 / 100);
    std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(at), values.end());
    return values[at];
}

/// True if a branch's leaves hang on it rather than around it at a distance.
bool bears_closely(const Bearing& bearing, const std::vector<std::uint32_t>& leaves, float crown, bool is_trunk) {
    std::vector<float> distances;
    for (const std::uint32_t leaf : leaves)
        distances.push_back(bearing.distance[leaf]);
    const bool near = percentile_95(distances) <= 0.2f * crown;
    return near && (!is_trunk || leaves.size() <= kMaximumLeavesPerTwig);
}

} // namespace

float crown_radius(const Tree& tree) {
    Box foliage, all;
    for (const TreePart& part : tree.parts)
        for (const glm::uvec3& triangle : part.triangles)
            for (const std::uint32_t v :
                 {triangle.x, triangle.y, triangle.z}) { // files may share vertices with other parts
                all.add(part.positions[v]);
                if (part.kind == TreePartKind::foliage)
                    foliage.add(part.positions[v]);
            }
    const glm::vec3 extent = foliage.low.x <= foliage.high.x ? foliage.extent() : all.extent();
    const float horizontal = std::max(extent.x, extent.z);
    return 0.5f * (horizontal > 0 ? horizontal : extent.y);
}

void infer_branching(Tree& tree) {
    tree.branching_known = false;
    BarkSkeleton bark = skeleton_of_bark(tree);
    tree.skeleton = std::move(bark.skeleton);
    if (tree.skeleton.branches.empty()) {
        tree.skeleton.branches.push_back(imagined_trunk(tree));
        tree.notes.push_back(std::string(bark.pieces > 0 ? "what is not foliage is too stout for wood" : "no bark") +
                             ": a trunk was imagined from the ground to the middle of the leaves");
    } else {
        tree.notes.push_back("branching inferred from " + counted(bark.pieces, "connected piece", "connected pieces") +
                             " of bark: " + counted(tree.skeleton.branches.size(), "branch", "branches") + ", " +
                             counted(bark.stems, "stem", "stems"));
        if (bark.lumps > 0)
            tree.notes.push_back(counted(bark.lumps, "piece", "pieces") +
                                 " of bark too stout for wood (stones, a pot) left out of the branching");
        if (bark.floating > 0)
            tree.notes.push_back(counted(bark.floating, "piece of bark touches", "pieces of bark touch") +
                                 " no thicker wood: joined to the nearest");
    }
    if (tree.leaves.empty())
        return;
    const float crown = crown_radius(tree);
    const Bearing bearing = assign_leaves(tree);
    TwigMaker maker(tree, crown);
    std::size_t led = 0;
    for (std::uint32_t branch = 0; branch < bearing.leaves.size(); ++branch) {
        std::vector<std::uint32_t> leaves = bearing.leaves[branch];
        if (leaves.empty() || bears_closely(bearing, leaves, crown, tree.skeleton.branches[branch].order == 0))
            continue;
        led += leaves.size();
        maker.add(branch, leaves);
    }
    if (maker.twigs > 0)
        tree.notes.push_back(counted(led, "leaf hangs", "leaves hang") +
                             " far from all wood: " + counted(maker.twigs, "twig was", "twigs were") +
                             " imagined that lead to clusters of them");
}

} // namespace kokage

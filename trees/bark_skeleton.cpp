#include "trees/bark_skeleton.h"

#include "common/geometry/point_tree.h"
#include "trees/bark_axis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace kokage {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// Turns a piece's axis tree into branches, the thickest way through it first.
class BranchWriter {
  public:
    explicit BranchWriter(Skeleton& skeleton) : skeleton_(skeleton) {}

    /// `parent` = -1: a stem. `joint`: where the piece leaves its parent, if it has one.
    void write(const std::vector<AxisNode>& nodes, std::int32_t parent, const Branch::Node* joint) {
        struct Start {
            std::uint32_t node;
            std::int32_t parent;
            bool at_fork;
        };
        std::vector<Start> starts{{0, parent, false}};
        for (std::size_t s = 0; s < starts.size(); ++s) {
            const Start start = starts[s];
            Branch branch;
            branch.parent = start.parent;
            branch.order = start.parent < 0 ? 0 : skeleton_.branches[std::size_t(start.parent)].order + 1;
            const auto index = std::int32_t(skeleton_.branches.size());
            if (start.at_fork)
                branch.nodes.push_back({nodes[nodes[start.node].parent].position, nodes[start.node].radius_m});
            else if (joint)
                branch.nodes.push_back({joint->position, std::min(joint->radius_m, nodes[0].radius_m)});
            for (std::uint32_t node = start.node;;) {
                branch.nodes.push_back({nodes[node].position, nodes[node].radius_m});
                const std::uint32_t next = main_child(nodes, node);
                if (next == kNone)
                    break;
                for (const std::uint32_t child : nodes[node].children)
                    if (child != next && is_limb(nodes, child))
                        starts.push_back({child, index, true});
                node = next;
            }
            skeleton_.branches.push_back(std::move(branch));
        }
    }

  private:
    /// The limb that goes on: the thickest; among those within a quarter of it, the longest.
    static std::uint32_t main_child(const std::vector<AxisNode>& nodes, std::uint32_t node) {
        float thickest = 0;
        for (const std::uint32_t child : nodes[node].children)
            if (is_limb(nodes, child) || nodes[node].children.size() == 1)
                thickest = std::max(thickest, limb_radius(nodes, child));
        std::uint32_t best = kNone;
        for (const std::uint32_t child : nodes[node].children) {
            if (nodes[node].children.size() > 1 && !is_limb(nodes, child))
                continue;
            if (limb_radius(nodes, child) >= 0.75f * thickest &&
                (best == kNone || nodes[child].reach > nodes[best].reach))
                best = child;
        }
        return best;
    }

    /// A limb's own radius shows a node after the fork, where its level set has come apart from its neighbours'.
    static float limb_radius(const std::vector<AxisNode>& nodes, std::uint32_t child) {
        return nodes[child].children.size() == 1
                   ? std::max(nodes[nodes[child].children[0]].radius_m, 0.5f * nodes[child].radius_m)
                   : nodes[child].radius_m;
    }

    /// Bumps of the bark are no limbs: a limb reaches farther from its fork than the wood is thick there.
    static bool is_limb(const std::vector<AxisNode>& nodes, std::uint32_t child) {
        const AxisNode& parent = nodes[nodes[child].parent];
        float thickness = parent.radius_m;
        for (const std::uint32_t sibling : parent.children)
            thickness = std::max(thickness, nodes[sibling].radius_m);
        return nodes[child].reach + glm::distance(nodes[child].position, parent.position) > 2.f * thickness;
    }

    Skeleton& skeleton_;
};

/// Where a piece meets wood that is already there.
struct Contact {
    std::uint32_t vertex = kNone, sample = kNone;
    float depth = std::numeric_limits<float>::infinity(); ///< distance from the axis less its radius: negative inside
    bool touches = false;
};

/// Wood that later pieces may hang on.
class StandingWood {
  public:
    /// The part of a branch within its parent is no place to hang on: the parent is.
    void add(const Skeleton& skeleton, std::size_t first_branch) {
        for (const AxisSamples::Sample& sample : sample_axes(skeleton, first_branch).samples) {
            const Branch& branch = skeleton.branches[sample.branch];
            if (branch.parent >= 0) {
                const glm::vec3& joint = branch.nodes[0].position;
                if (glm::distance(joint, sample.position) <=
                    radius_near(skeleton.branches[std::size_t(branch.parent)], joint))
                    continue;
            }
            samples.push_back(sample);
            tree_.add(sample.position);
        }
    }

    Contact nearest(const glm::vec3& place, std::uint32_t vertex, float reach) const {
        const NearestPoint found = tree_.nearest(place);
        if (!found.found())
            return {};
        const float depth = found.distance - samples[found.index].radius_m;
        return {vertex, found.index, depth, depth <= reach};
    }

    std::vector<AxisSamples::Sample> samples;

  private:
    static float radius_near(const Branch& branch, const glm::vec3& place) {
        const auto nearest = std::min_element(
            branch.nodes.begin(), branch.nodes.end(), [&](const Branch::Node& a, const Branch::Node& b) {
                return glm::distance(a.position, place) < glm::distance(b.position, place);
            });
        return nearest->radius_m;
    }

    GrowingPointTree tree_;
};

/// An end of the piece that lies in or on standing wood (the thicker one, if both do); else whichever vertex reaches
/// deepest.
Contact find_contact(BarkMesh& mesh, const BarkPiece& piece, const StandingWood& wood) {
    const std::array<BarkEnd, 2> ends = mesh.ends(piece);
    std::array<Contact, 2> contacts;
    for (std::size_t e = 0; e < 2; ++e)
        contacts[e] = wood.nearest(ends[e].centre, ends[e].vertex, 0.5f * ends[e].radius_m);
    if (contacts[0].touches || contacts[1].touches) {
        const bool first = contacts[0].touches != contacts[1].touches   ? contacts[0].touches
                           : ends[0].radius_m > 1.2f * ends[1].radius_m ? true
                           : ends[1].radius_m > 1.2f * ends[0].radius_m ? false
                                                                        : contacts[0].depth < contacts[1].depth;
        return contacts[first ? 0 : 1];
    }
    Contact deepest;
    for (const std::uint32_t v : piece.vertices) {
        const Contact contact = wood.nearest(mesh.position(v), v, float(piece.thickness));
        if (contact.depth < deepest.depth)
            deepest = contact;
    }
    return deepest;
}

std::uint32_t lowest_vertex(const BarkMesh& mesh, const BarkPiece& piece) {
    return *std::min_element(piece.vertices.begin(), piece.vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
        const float ya = mesh.position(a).y, yb = mesh.position(b).y;
        return ya != yb ? ya < yb : a < b;
    });
}

/// The trunk first, then thick before thin.
std::vector<std::size_t> joining_order(const std::vector<BarkPiece>& pieces, double low, double high) {
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return pieces[a].thickness > pieces[b].thickness; });
    auto trunk = order.end();
    for (auto i = order.begin(); i != order.end(); ++i)
        if (pieces[*i].low.y <= low + 0.1 * (high - low) &&
            (trunk == order.end() || pieces[*i].area > pieces[*trunk].area))
            trunk = i;
    if (trunk != order.end())
        std::rotate(order.begin(), trunk, trunk + 1);
    return order;
}

} // namespace

AxisSamples sample_axes(const Skeleton& skeleton, std::size_t first_branch) {
    AxisSamples axes;
    for (std::size_t b = first_branch; b < skeleton.branches.size(); ++b) {
        const std::vector<Branch::Node>& nodes = skeleton.branches[b].nodes;
        for (std::size_t n = 0; n < nodes.size(); ++n) {
            axes.samples.push_back({nodes[n].position, nodes[n].radius_m, std::uint32_t(b)});
            if (n + 1 == nodes.size())
                break;
            const float length = glm::distance(nodes[n].position, nodes[n + 1].position);
            const float radius = std::max(nodes[n].radius_m, nodes[n + 1].radius_m);
            const int steps = radius > 0 ? int(std::clamp(std::ceil(length / radius), 1.f, 32.f)) : 4;
            for (int s = 1; s < steps; ++s) {
                const float t = float(s) / float(steps);
                axes.samples.push_back({glm::mix(nodes[n].position, nodes[n + 1].position, t),
                                        glm::mix(nodes[n].radius_m, nodes[n + 1].radius_m, t), std::uint32_t(b)});
            }
        }
    }
    return axes;
}

BarkSkeleton skeleton_from_bark(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    BarkSkeleton result;
    BarkMesh mesh(positions, triangles);
    result.pieces = mesh.pieces().size();
    if (mesh.pieces().empty())
        return result;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const BarkPiece& piece : mesh.pieces()) {
        low = std::min(low, piece.low.y);
        high = std::max(high, piece.high.y);
    }
    StandingWood wood;
    BranchWriter writer(result.skeleton);
    for (const std::size_t p : joining_order(mesh.pieces(), low, high)) {
        const BarkPiece& piece = mesh.pieces()[p];
        const Contact contact = find_contact(mesh, piece, wood);
        const bool stem = contact.sample == kNone || (!contact.touches && piece.low.y <= low + 0.1 * (high - low));
        const std::size_t first = result.skeleton.branches.size();
        if (stem) {
            writer.write(mesh.axis_tree(piece, lowest_vertex(mesh, piece)), -1, nullptr);
            ++result.stems;
        } else {
            const AxisSamples::Sample& sample = wood.samples[contact.sample];
            const Branch::Node joint{sample.position, sample.radius_m};
            writer.write(mesh.axis_tree(piece, contact.vertex), std::int32_t(sample.branch), &joint);
            result.floating += contact.touches ? 0 : 1;
        }
        wood.add(result.skeleton, first);
    }
    return result;
}

} // namespace kokage

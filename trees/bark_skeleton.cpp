#include "trees/bark_skeleton.h"

#include "trees/bark_axis.h"
#include "trees/standing_wood.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace kokage {
namespace {

constexpr std::uint32_t kNoNode = ~0u;

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
            else if (joint && glm::distance(joint->position, nodes[0].position) > 0.1f * joint->radius_m)
                branch.nodes.push_back({joint->position, std::min(joint->radius_m, nodes[0].radius_m)});
            for (std::uint32_t node = start.node;;) {
                branch.nodes.push_back({nodes[node].position, nodes[node].radius_m});
                const std::uint32_t next = main_child(nodes, node);
                if (next == kNoNode)
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
        std::uint32_t best = kNoNode;
        for (const std::uint32_t child : nodes[node].children) {
            if (nodes[node].children.size() > 1 && !is_limb(nodes, child))
                continue;
            if (limb_radius(nodes, child) >= 0.75f * thickest &&
                (best == kNoNode || nodes[child].reach > nodes[best].reach))
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

/// Where a tube begins and ends, as BarkMesh::ends() tells it of any piece.
std::array<BarkEnd, 2> ends_of(const TubeAxis& tube) {
    const AxisNode &base = tube.nodes.front(), &tip = tube.nodes.back();
    return {BarkEnd{0, base.position, base.radius_m}, BarkEnd{1, tip.position, tip.radius_m}};
}

/// Where a piece meets wood that is already there.
struct Contact {
    std::uint32_t vertex = kNoNode; ///< of a tube: 0 its base, 1 its tip
    WoodHold hold;
};

/// An end of the piece that lies in or on standing wood (the thicker one, if both do); else whichever vertex reaches
/// deepest.
Contact find_contact(BarkMesh& mesh, const BarkPiece& piece, const std::optional<TubeAxis>& tube,
                     const StandingWood& wood) {
    const std::array<BarkEnd, 2> ends = tube ? ends_of(*tube) : mesh.ends(piece);
    std::array<Contact, 2> contacts;
    for (std::size_t e = 0; e < 2; ++e)
        contacts[e] = {ends[e].vertex, wood.nearest(ends[e].centre, 0.5f * ends[e].radius_m)};
    if (contacts[0].hold.touches || contacts[1].hold.touches) {
        const bool first = contacts[0].hold.touches != contacts[1].hold.touches ? contacts[0].hold.touches
                           : ends[0].radius_m > 1.2f * ends[1].radius_m         ? true
                           : ends[1].radius_m > 1.2f * ends[0].radius_m
                               ? false
                               : contacts[0].hold.depth < contacts[1].hold.depth;
        return contacts[first ? 0 : 1];
    }
    Contact deepest;
    if (tube) { // its ends alone: what else it touches it grows past
        deepest = contacts[contacts[1].hold.depth < contacts[0].hold.depth ? 1 : 0];
        return deepest;
    }
    for (const std::uint32_t v : piece.vertices) {
        const Contact contact{v, wood.nearest(mesh.position(v), float(piece.thickness))};
        if (contact.hold.depth < deepest.hold.depth)
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

/// Wood is long for its thickness; stones, pots and lumps of soil are not.
bool is_long(const std::vector<AxisNode>& nodes) {
    constexpr float kLeastLength = 3; // in radii
    float thickest = 0;
    for (const AxisNode& node : nodes)
        thickest = std::max(thickest, node.radius_m);
    return nodes.front().reach >= kLeastLength * thickest;
}

/// The trunk first, then thick before thin.
std::vector<std::size_t> joining_order(const std::vector<BarkPiece>& pieces,
                                       const std::vector<std::optional<TubeAxis>>& tubes,
                                       const std::vector<bool>& is_wood, double low, double high) {
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    const auto thickness = [&](std::size_t piece) { // in steps of 4 %, so that rounding does not decide
        const double radius = tubes[piece] ? double(tubes[piece]->base_radius_m) : pieces[piece].thickness;
        return radius > 0 ? int(std::lround(16 * std::log2(radius))) : std::numeric_limits<int>::min();
    };
    const auto place = [&](std::size_t piece) { // so that the order of the file does not matter
        const BarkPiece& p = pieces[piece];
        return std::array{p.low.x, p.low.y, p.low.z, p.high.x, p.high.y, p.high.z};
    };
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return thickness(a) != thickness(b) ? thickness(a) > thickness(b) : place(a) < place(b);
    });
    // Hanging boughs may reach lower than the trunk, and have more bark.
    const auto volume = [&](std::size_t piece) {
        return pieces[piece].area * (tubes[piece] ? double(tubes[piece]->base_radius_m) : pieces[piece].thickness);
    };
    auto trunk = order.end();
    for (auto i = order.begin(); i != order.end(); ++i)
        if (is_wood[*i] && pieces[*i].low.y <= 0.5 * (low + high) &&
            (trunk == order.end() || volume(*i) > volume(*trunk)))
            trunk = i;
    if (trunk != order.end())
        std::rotate(order.begin(), trunk, trunk + 1);
    return order;
}

/// Joins pieces to one another, branch by branch.
class PieceJoiner {
  public:
    PieceJoiner(BarkMesh& mesh, BarkSkeleton& result) : mesh_(mesh), result_(result), writer_(result.skeleton) {
        for (const BarkPiece& piece : mesh.pieces()) {
            tubes_.push_back(mesh.tube_axis(piece));
            is_wood_.push_back(
                is_long(tubes_.back() ? tubes_.back()->nodes : mesh.axis_tree(piece, lowest_vertex(mesh, piece))));
            low_ = std::min(low_, piece.low.y);
            high_ = std::max(high_, piece.high.y);
        }
    }

    /// First what begins exactly on the axis of wood that stands, as often as more does; then the others, the thickest
    /// first.
    void join_all() {
        constexpr int kMostRounds = 64;
        std::vector<std::size_t> pending = joining_order(mesh_.pieces(), tubes_, is_wood_, low_, high_);
        if (!is_wood_[pending.front()]) // then none that reaches low is
            return;
        ground_ = mesh_.pieces()[pending.front()].low.y;
        join(pending.front());
        pending.erase(pending.begin());
        for (int round = 0; round < kMostRounds; ++round)
            if (std::erase_if(pending, [&](std::size_t piece) { return join_on_axis(piece); }) == 0)
                break;
        for (const std::size_t piece : pending) {
            if (is_wood_[piece])
                join(piece);
            else
                ++result_.lumps;
        }
    }

  private:
    bool near_ground(const BarkPiece& piece) const { return piece.low.y <= ground_ + 0.1 * (high_ - low_); }

    bool join_on_axis(std::size_t piece) {
        if (!tubes_[piece])
            return false;
        const WoodHold hold = wood_.on_axis(tubes_[piece]->nodes.front().position);
        if (hold.touches)
            hang(piece, {0, hold});
        return hold.touches;
    }

    void join(std::size_t piece) {
        const Contact contact = find_contact(mesh_, mesh_.pieces()[piece], tubes_[piece], wood_);
        if (contact.hold.axis.found && (contact.hold.touches || !near_ground(mesh_.pieces()[piece]))) {
            hang(piece, contact);
            return;
        }
        const std::size_t first = result_.skeleton.branches.size();
        std::uint32_t base = 0;
        if (!tubes_[piece])
            base = lowest_vertex(mesh_, mesh_.pieces()[piece]);
        else if (tubes_[piece]->nodes.back().position.y < tubes_[piece]->nodes.front().position.y)
            base = 1;
        writer_.write(axis_from(piece, base), -1, nullptr);
        ++result_.stems;
        wood_.add(result_.skeleton, first);
    }

    void hang(std::size_t piece, const Contact& contact) {
        const std::size_t first = result_.skeleton.branches.size();
        const Branch::Node joint{contact.hold.axis.position, contact.hold.axis.radius_m};
        writer_.write(axis_from(piece, contact.vertex), std::int32_t(contact.hold.axis.branch), &joint);
        result_.floating += contact.hold.touches ? 0 : 1;
        wood_.add(result_.skeleton, first);
    }

    /// `base`: a vertex; of a tube 0 or 1, as in Contact.
    std::vector<AxisNode> axis_from(std::size_t piece, std::uint32_t base) {
        if (!tubes_[piece])
            return mesh_.axis_tree(mesh_.pieces()[piece], base);
        if (base == 1)
            reverse_chain(tubes_[piece]->nodes);
        return tubes_[piece]->nodes;
    }

    BarkMesh& mesh_;
    BarkSkeleton& result_;
    BranchWriter writer_;
    StandingWood wood_;
    std::vector<std::optional<TubeAxis>> tubes_;
    std::vector<bool> is_wood_; ///< by its shape; what begins on an axis is wood in any case
    double low_ = std::numeric_limits<double>::infinity(), high_ = -low_;
    double ground_ = 0; ///< where the trunk begins
};

} // namespace

BarkSkeleton skeleton_from_bark(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles) {
    BarkSkeleton result;
    BarkMesh mesh(positions, triangles);
    result.pieces = mesh.pieces().size();
    if (!mesh.pieces().empty())
        PieceJoiner(mesh, result).join_all();
    return result;
}

} // namespace kokage

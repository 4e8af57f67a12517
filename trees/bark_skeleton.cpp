#include "trees/bark_skeleton.h"

#include "common/geometry/point_tree.h"
#include "common/geometry/triangle_topology.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <queue>

namespace kokage {
namespace {

constexpr std::uint32_t kNone = ~0u;

/// A connected piece of bark.
struct Piece {
    std::vector<std::uint32_t> vertices; ///< welded representatives
    double area = 0;
    double thickness = 0; ///< radius of the tube that has its area and length
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
};

/// A node of a piece's axis tree.
struct AxisNode {
    glm::vec3 position{0.f};
    float radius_m = 0;
    std::uint32_t parent = kNone;
    std::vector<std::uint32_t> children;
    float reach = 0; ///< length of the longest way from here to a tip
};

class BarkMesh {
  public:
    BarkMesh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles)
        : positions_(positions), welded_(weld(positions)), neighbours_(vertex_neighbours(triangles, welded_)) {
        find_pieces(triangles);
    }

    std::vector<Piece> pieces;

    const glm::vec3& position(std::uint32_t vertex) const { return positions_[vertex]; }

    /// Distances along edges from a vertex, for the vertices of its piece; kept in `distance_` (others are left as they
    /// were).
    const std::vector<float>& distances_from(std::uint32_t base, const Piece& piece) {
        distance_.resize(positions_.size());
        for (const std::uint32_t v : piece.vertices)
            distance_[v] = std::numeric_limits<float>::infinity();
        using Entry = std::pair<float, std::uint32_t>;
        std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
        distance_[base] = 0;
        queue.emplace(0.f, base);
        while (!queue.empty()) {
            const auto [distance, v] = queue.top();
            queue.pop();
            if (distance > distance_[v])
                continue;
            for (const std::uint32_t other : neighbours_.of(v)) {
                const float further = distance + glm::distance(positions_[v], positions_[other]);
                if (further < distance_[other]) {
                    distance_[other] = further;
                    queue.emplace(further, other);
                }
            }
        }
        return distance_;
    }

    std::vector<AxisNode> axis_tree(const Piece& piece, std::uint32_t base);

  private:
    void find_pieces(std::span<const glm::uvec3> triangles) {
        const std::vector<std::uint32_t> component = connected_components(neighbours_);
        std::vector<std::uint32_t> piece_of(component.size(), kNone);
        for (std::uint32_t v = 0; v < component.size(); ++v) {
            if (welded_[v] != v || neighbours_.of(v).empty())
                continue;
            if (piece_of[component[v]] == kNone) {
                piece_of[component[v]] = std::uint32_t(pieces.size());
                pieces.emplace_back();
            }
            Piece& piece = pieces[piece_of[component[v]]];
            piece.vertices.push_back(v);
            piece.low = glm::min(piece.low, glm::dvec3(positions_[v]));
            piece.high = glm::max(piece.high, glm::dvec3(positions_[v]));
        }
        for (const glm::uvec3& t : triangles) {
            const std::uint32_t piece = piece_of[component[welded_[t.x]]];
            const glm::dvec3 a(positions_[t.x]), b(positions_[t.y]), c(positions_[t.z]);
            if (piece != kNone)
                pieces[piece].area += 0.5 * glm::length(glm::cross(b - a, c - a));
        }
        for (Piece& piece : pieces) {
            const double length = glm::length(piece.high - piece.low);
            piece.thickness = length > 0 ? piece.area / (2 * kPiDouble * length) : 0;
        }
    }

    std::span<const glm::vec3> positions_;
    std::vector<std::uint32_t> welded_;
    Adjacency neighbours_;
    std::vector<float> distance_;
    std::vector<std::uint32_t> node_of_; ///< per vertex, within the piece at work
};

std::vector<AxisNode> BarkMesh::axis_tree(const Piece& piece, std::uint32_t base) {
    const std::vector<float>& distance = distances_from(base, piece);
    float furthest = 0;
    for (const std::uint32_t v : piece.vertices)
        furthest = std::max(furthest, distance[v]);
    const float width = std::max(1.5f * float(piece.thickness), furthest / 256);
    const auto level = [&](std::uint32_t v) { return width > 0 ? int(distance[v] / width) : 0; };

    // A node for each connected part of a level.
    node_of_.resize(positions_.size());
    for (const std::uint32_t v : piece.vertices)
        node_of_[v] = kNone;
    std::vector<AxisNode> nodes;
    std::vector<int> node_level;
    std::vector<std::uint32_t> stack;
    for (const std::uint32_t start : piece.vertices) {
        if (node_of_[start] != kNone)
            continue;
        const std::uint32_t node = std::uint32_t(nodes.size());
        std::vector<std::uint32_t> members;
        node_of_[start] = node;
        stack.assign(1, start);
        while (!stack.empty()) {
            const std::uint32_t v = stack.back();
            stack.pop_back();
            members.push_back(v);
            for (const std::uint32_t other : neighbours_.of(v))
                if (node_of_[other] == kNone && level(other) == level(start)) {
                    node_of_[other] = node;
                    stack.push_back(other);
                }
        }
        glm::dvec3 centre(0.0);
        for (const std::uint32_t v : members)
            centre += glm::dvec3(positions_[v]);
        centre /= double(members.size());
        double radius = 0;
        for (const std::uint32_t v : members)
            radius += glm::distance(glm::dvec3(positions_[v]), centre);
        nodes.push_back({glm::vec3(centre), float(radius / double(members.size())), kNone, {}, 0.f});
        node_level.push_back(level(start));
    }
    // Each node hangs on its neighbour in the highest level below it.
    for (const std::uint32_t v : piece.vertices)
        for (const std::uint32_t other : neighbours_.of(v)) {
            const std::uint32_t here = node_of_[v], there = node_of_[other];
            if (node_level[there] >= node_level[here])
                continue;
            std::uint32_t& parent = nodes[here].parent;
            if (parent == kNone || node_level[there] > node_level[parent] ||
                (node_level[there] == node_level[parent] && there < parent))
                parent = there;
        }
    // Root first, then by level, so that parents come before children.
    std::vector<std::uint32_t> order(nodes.size()), rank(nodes.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return node_level[a] < node_level[b]; });
    for (std::uint32_t i = 0; i < order.size(); ++i)
        rank[order[i]] = i;
    std::vector<AxisNode> sorted(nodes.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        sorted[i] = nodes[order[i]];
        if (sorted[i].parent != kNone)
            sorted[i].parent = rank[sorted[i].parent];
        else if (i > 0)
            sorted[i].parent = 0;
        if (i > 0)
            sorted[sorted[i].parent].children.push_back(i);
    }
    for (std::uint32_t i = std::uint32_t(sorted.size()); i-- > 1;) {
        AxisNode& parent = sorted[sorted[i].parent];
        parent.reach = std::max(parent.reach, sorted[i].reach + glm::distance(parent.position, sorted[i].position));
    }
    return sorted;
}

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
        return nodes[child].reach + glm::distance(nodes[child].position, parent.position) > 2.f * parent.radius_m;
    }

    Skeleton& skeleton_;
};

/// The vertex of a piece that reaches deepest into wood that is already there, and the sample it reaches.
struct Contact {
    std::uint32_t vertex = kNone, sample = kNone;
    float depth = std::numeric_limits<float>::infinity(); ///< distance from the axis less its radius: negative inside
};

Contact deepest_contact(const BarkMesh& mesh, const Piece& piece, const GrowingPointTree& tree,
                        const AxisSamples& axes) {
    Contact contact;
    for (const std::uint32_t v : piece.vertices) {
        const NearestPoint nearest = tree.nearest(mesh.position(v));
        if (!nearest.found())
            break;
        const float depth = nearest.distance - axes.samples[nearest.index].radius_m;
        if (depth < contact.depth)
            contact = {v, nearest.index, depth};
    }
    return contact;
}

std::uint32_t lowest_vertex(const BarkMesh& mesh, const Piece& piece) {
    return *std::min_element(piece.vertices.begin(), piece.vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
        const float ya = mesh.position(a).y, yb = mesh.position(b).y;
        return ya != yb ? ya < yb : a < b;
    });
}

/// The trunk first, then thick before thin.
std::vector<std::size_t> joining_order(const std::vector<Piece>& pieces, double low, double high) {
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
    result.pieces = mesh.pieces.size();
    if (mesh.pieces.empty())
        return result;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Piece& piece : mesh.pieces) {
        low = std::min(low, piece.low.y);
        high = std::max(high, piece.high.y);
    }
    AxisSamples axes;
    GrowingPointTree tree;
    BranchWriter writer(result.skeleton);
    for (const std::size_t p : joining_order(mesh.pieces, low, high)) {
        const Piece& piece = mesh.pieces[p];
        const Contact contact = deepest_contact(mesh, piece, tree, axes);
        const bool touches = contact.sample != kNone && contact.depth <= float(piece.thickness);
        const bool stem = contact.sample == kNone || (!touches && piece.low.y <= low + 0.1 * (high - low));
        const std::size_t first = result.skeleton.branches.size();
        if (stem) {
            writer.write(mesh.axis_tree(piece, lowest_vertex(mesh, piece)), -1, nullptr);
            ++result.stems;
        } else {
            const AxisSamples::Sample& sample = axes.samples[contact.sample];
            const Branch::Node joint{sample.position, sample.radius_m};
            writer.write(mesh.axis_tree(piece, contact.vertex), std::int32_t(sample.branch), &joint);
            result.floating += touches ? 0 : 1;
        }
        for (const AxisSamples::Sample& sample : sample_axes(result.skeleton, first).samples) {
            axes.samples.push_back(sample);
            tree.add(sample.position);
        }
    }
    return result;
}

} // namespace kokage

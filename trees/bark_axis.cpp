#include "trees/bark_axis.h"

#include "trees/level_set_axis.h"

#include <algorithm>
#include <cmath>
#include <queue>

namespace kokage {
namespace {

constexpr std::uint32_t kNone = ~0u;

glm::vec3 centre_of(const std::vector<std::uint32_t>& ring, std::span<const glm::vec3> positions) {
    glm::dvec3 sum(0.0);
    for (const std::uint32_t v : ring)
        sum += glm::dvec3(positions[v]);
    return glm::vec3(sum / double(ring.size()));
}

/// Links a chain as an axis tree.
void link_chain(std::vector<AxisNode>& nodes) {
    for (std::uint32_t i = 0; i < nodes.size(); ++i) {
        nodes[i].parent = i > 0 ? i - 1 : kNone;
        nodes[i].children.clear();
        if (i + 1 < nodes.size())
            nodes[i].children.push_back(i + 1);
    }
    nodes.back().reach = 0;
    for (std::size_t i = nodes.size() - 1; i-- > 0;)
        nodes[i].reach = nodes[i + 1].reach + glm::distance(nodes[i].position, nodes[i + 1].position);
}

/// How far rings are from round: the mean, over all vertices, of how much their distance from the centre differs from
/// the ring's mean. Rings that are cut aslant are not round.
double unevenness(const std::vector<std::vector<std::uint32_t>>& rings, std::span<const glm::vec3> positions) {
    double sum = 0, count = 0;
    for (const std::vector<std::uint32_t>& ring : rings) {
        const glm::vec3 centre = centre_of(ring, positions);
        double radius = 0;
        for (const std::uint32_t v : ring)
            radius += double(glm::distance(positions[v], centre));
        radius /= double(ring.size());
        count += double(ring.size());
        for (const std::uint32_t v : ring)
            sum += radius > 0 ? std::abs(double(glm::distance(positions[v], centre)) / radius - 1) : 0.0;
    }
    return sum / count;
}

} // namespace

void reverse_chain(std::vector<AxisNode>& nodes) {
    std::reverse(nodes.begin(), nodes.end());
    link_chain(nodes);
}

BarkMesh::BarkMesh(std::span<const glm::vec3> positions, std::span<const glm::uvec3> triangles)
    : positions_(positions), welded_(weld(positions)), neighbours_(vertex_neighbours(triangles, welded_)),
      distance_(positions.size(), 0.f), node_of_(positions.size(), kNone) {
    find_pieces(triangles);
    find_rims(triangles);
}

void BarkMesh::find_rims(std::span<const glm::uvec3> triangles) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    edges.reserve(3 * triangles.size());
    for (const glm::uvec3& t : triangles)
        for (int c = 0; c < 3; ++c) {
            const std::uint32_t a = welded_[t[c]], b = welded_[t[(c + 1) % 3]];
            if (a != b)
                edges.emplace_back(std::min(a, b), std::max(a, b));
        }
    std::sort(edges.begin(), edges.end());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i + 1;
        while (end < edges.size() && edges[end] == edges[i])
            ++end;
        if (end == i + 1) {
            pairs.push_back(edges[i]);
            pairs.emplace_back(edges[i].second, edges[i].first);
        }
        i = end;
    }
    std::sort(pairs.begin(), pairs.end());
    rims_.first.assign(positions_.size() + 1, 0);
    for (const auto& [from, to] : pairs) {
        ++rims_.first[from + 1];
        rims_.items.push_back(to);
    }
    for (std::size_t i = 0; i < positions_.size(); ++i)
        rims_.first[i + 1] += rims_.first[i];
}

/// The open edge that a vertex lies on, empty if it lies on none.
std::vector<std::uint32_t> BarkMesh::rim_of(std::uint32_t vertex, const BarkPiece& piece) {
    std::vector<std::uint32_t> rim;
    if (rims_.of(vertex).empty())
        return rim;
    for (const std::uint32_t v : piece.vertices)
        node_of_[v] = kNone;
    rim.push_back(vertex);
    node_of_[vertex] = 0;
    for (std::size_t i = 0; i < rim.size(); ++i)
        for (const std::uint32_t other : rims_.of(rim[i]))
            if (node_of_[other] == kNone) {
                node_of_[other] = 0;
                rim.push_back(other);
            }
    return rim;
}

/// What lies 0, 1, 2, ... edges away from a start; empty if some of these sets is not connected.
std::vector<std::vector<std::uint32_t>> BarkMesh::rings_from(const std::vector<std::uint32_t>& start,
                                                             const BarkPiece& piece) {
    for (const std::uint32_t v : piece.vertices)
        node_of_[v] = kNone;
    std::vector<std::vector<std::uint32_t>> rings{start};
    for (const std::uint32_t v : start)
        node_of_[v] = 0;
    while (true) {
        const std::uint32_t number = std::uint32_t(rings.size());
        std::vector<std::uint32_t> ring;
        for (const std::uint32_t v : rings.back())
            for (const std::uint32_t other : neighbours_.of(v))
                if (node_of_[other] == kNone) {
                    node_of_[other] = number;
                    ring.push_back(other);
                }
        if (ring.empty())
            break;
        rings.push_back(std::move(ring));
    }
    std::vector<std::uint32_t> reached;
    for (std::size_t r = 0; r < rings.size(); ++r) { // kNone marks what has been reached again
        reached.assign(1, rings[r].front());
        node_of_[rings[r].front()] = kNone;
        for (std::size_t i = 0; i < reached.size(); ++i)
            for (const std::uint32_t other : neighbours_.of(reached[i]))
                if (node_of_[other] == r) {
                    node_of_[other] = kNone;
                    reached.push_back(other);
                }
        if (reached.size() != rings[r].size())
            return {};
    }
    return rings;
}

std::optional<TubeAxis> BarkMesh::tube_axis(const BarkPiece& piece) {
    constexpr double kMostUneven = 0.25;
    std::vector<std::vector<std::uint32_t>> best;
    double least = kMostUneven;
    for (const BarkEnd& end : ends(piece)) {
        const std::vector<std::uint32_t> rim = rim_of(end.vertex, piece);
        std::vector<std::vector<std::uint32_t>> rings =
            rings_from(rim.empty() ? std::vector<std::uint32_t>{end.vertex} : rim, piece);
        if (rings.size() < 2)
            continue;
        if (const double uneven = unevenness(rings, positions_); uneven < least) {
            least = uneven;
            best = std::move(rings);
        }
    }
    if (best.empty())
        return std::nullopt;
    TubeAxis axis;
    for (const std::vector<std::uint32_t>& ring : best) {
        AxisNode node;
        node.position = centre_of(ring, positions_);
        for (const std::uint32_t v : ring)
            node.radius_m += glm::distance(positions_[v], node.position) / float(ring.size());
        axis.nodes.push_back(std::move(node));
    }
    // Radii at a quarter of the rings from either end tell which is the base.
    const std::size_t count = axis.nodes.size(), quarter = count / 4;
    if (axis.nodes[quarter].radius_m < axis.nodes[count - 1 - quarter].radius_m)
        std::reverse(axis.nodes.begin(), axis.nodes.end());
    for (std::size_t i = 0; i < count; ++i) { // medians of three: single bumps, such as collars, don't count
        const float here = axis.nodes[i].radius_m, before = axis.nodes[i > 0 ? i - 1 : 0].radius_m,
                    after = axis.nodes[std::min(i + 1, count - 1)].radius_m;
        axis.base_radius_m =
            std::max(axis.base_radius_m, std::max(std::min(here, before), std::min(std::max(here, before), after)));
    }
    link_chain(axis.nodes);
    return axis;
}

void BarkMesh::find_pieces(std::span<const glm::uvec3> triangles) {
    const std::vector<std::uint32_t> component = connected_components(neighbours_);
    std::vector<std::uint32_t> piece_of(component.size(), kNone);
    for (std::uint32_t v = 0; v < component.size(); ++v) {
        if (welded_[v] != v || neighbours_.of(v).empty())
            continue;
        if (piece_of[component[v]] == kNone) {
            piece_of[component[v]] = std::uint32_t(pieces_.size());
            pieces_.emplace_back();
        }
        BarkPiece& piece = pieces_[piece_of[component[v]]];
        piece.vertices.push_back(v);
        piece.low = glm::min(piece.low, glm::dvec3(positions_[v]));
        piece.high = glm::max(piece.high, glm::dvec3(positions_[v]));
    }
    for (const glm::uvec3& t : triangles) {
        const std::uint32_t piece = piece_of[component[welded_[t.x]]];
        const glm::dvec3 a(positions_[t.x]), b(positions_[t.y]), c(positions_[t.z]);
        if (piece != kNone)
            pieces_[piece].area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    for (BarkPiece& piece : pieces_) {
        const double length = glm::length(piece.high - piece.low);
        piece.thickness = length > 0 ? piece.area / (2 * kPiDouble * length) : 0;
    }
}

/// Dijkstra along edges.
void BarkMesh::measure_distances(std::uint32_t from, const BarkPiece& piece) {
    for (const std::uint32_t v : piece.vertices)
        distance_[v] = std::numeric_limits<float>::infinity();
    using Entry = std::pair<float, std::uint32_t>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    distance_[from] = 0;
    queue.emplace(0.f, from);
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
}

std::uint32_t BarkMesh::furthest_vertex(const BarkPiece& piece) const {
    return *std::max_element(piece.vertices.begin(), piece.vertices.end(),
                             [&](std::uint32_t a, std::uint32_t b) { return distance_[a] < distance_[b]; });
}

std::array<BarkEnd, 2> BarkMesh::ends(const BarkPiece& piece) {
    std::array<BarkEnd, 2> result;
    measure_distances(piece.vertices.front(), piece);
    result[1].vertex = furthest_vertex(piece);
    for (std::size_t e = 0; e < 2; ++e) { // each as seen from the other: the ring of vertices that are farthest away
        measure_distances(result[1 - e].vertex, piece);
        result[e].vertex = furthest_vertex(piece);
        const float limit = distance_[result[e].vertex] - float(piece.thickness);
        glm::dvec3 sum(0.0);
        std::vector<std::uint32_t> ring;
        for (const std::uint32_t v : piece.vertices)
            if (distance_[v] >= limit) {
                ring.push_back(v);
                sum += glm::dvec3(positions_[v]);
            }
        sum /= double(ring.size());
        double radius = 0;
        for (const std::uint32_t v : ring)
            radius += glm::distance(glm::dvec3(positions_[v]), sum);
        result[e].centre = glm::vec3(sum);
        result[e].radius_m = float(radius / double(ring.size()));
    }
    return result;
}

std::vector<AxisNode> BarkMesh::axis_tree(const BarkPiece& piece, std::uint32_t base) {
    measure_distances(base, piece);
    const std::uint32_t tip = furthest_vertex(piece);
    measure_distances(tip, piece);
    const float width = std::max(1.5f * float(piece.thickness), distance_[furthest_vertex(piece)] / 256);
    return LevelSetAxis{positions_, neighbours_, distance_, node_of_}.tree(piece.vertices, width, base);
}

} // namespace kokage

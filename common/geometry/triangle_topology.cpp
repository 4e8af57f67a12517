#include "common/geometry/triangle_topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>

#include "common/services/random.h"

namespace kokage {
namespace {

struct PlaceHash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& bits) const {
        return std::size_t(hash64(bits[0] | std::uint64_t(bits[1]) << 32) ^ (hash64(bits[2]) * 3));
    }
};

struct TriangleEdge {
    std::uint32_t low, high, triangle;
    bool same_place(const TriangleEdge& other) const { return low == other.low && high == other.high; }
};

Adjacency rows_from_pairs(std::size_t count, std::vector<std::pair<std::uint32_t, std::uint32_t>>& pairs) {
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    Adjacency result;
    result.first.assign(count + 1, 0);
    result.items.reserve(pairs.size());
    for (const auto& [from, to] : pairs) {
        ++result.first[from + 1];
        result.items.push_back(to);
    }
    for (std::size_t i = 0; i < count; ++i)
        result.first[i + 1] += result.first[i];
    return result;
}

std::vector<TriangleEdge> welded_edges(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> welded) {
    std::vector<TriangleEdge> edges;
    edges.reserve(triangles.size() * 3);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t a = welded[triangles[t][c]], b = welded[triangles[t][(c + 1) % 3]];
            if (a != b)
                edges.push_back({std::min(a, b), std::max(a, b), std::uint32_t(t)});
        }
    std::sort(edges.begin(), edges.end(), [](const TriangleEdge& a, const TriangleEdge& b) {
        return a.low != b.low ? a.low < b.low : a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    return edges;
}

} // namespace

std::vector<std::uint32_t> weld(std::span<const glm::vec3> positions) {
    std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, PlaceHash> places;
    places.reserve(positions.size());
    std::vector<std::uint32_t> welded(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        std::array<std::uint32_t, 3> bits{};
        for (std::size_t c = 0; c < 3; ++c)
            bits[c] = std::bit_cast<std::uint32_t>(positions[i][c] + 0.f); // -0 becomes 0
        welded[i] = places.try_emplace(bits, std::uint32_t(i)).first->second;
    }
    return welded;
}

Adjacency triangle_neighbours(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> welded) {
    const std::vector<TriangleEdge> edges = welded_edges(triangles, welded);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    const auto join = [&](std::size_t i, std::size_t j) {
        if (edges[i].triangle == edges[j].triangle)
            return;
        pairs.emplace_back(edges[i].triangle, edges[j].triangle);
        pairs.emplace_back(edges[j].triangle, edges[i].triangle);
    };
    for (std::size_t begin = 0; begin < edges.size();) {
        std::size_t end = begin + 1;
        while (end < edges.size() && edges[end].same_place(edges[begin]))
            ++end;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = i + 1; j < (end - begin > 8 ? std::min(i + 2, end) : end); ++j)
                join(i, j);
        begin = end;
    }
    return rows_from_pairs(triangles.size(), pairs);
}

Adjacency vertex_neighbours(std::span<const glm::uvec3> triangles, std::span<const std::uint32_t> welded) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    pairs.reserve(triangles.size() * 6);
    for (const TriangleEdge& edge : welded_edges(triangles, welded)) {
        pairs.emplace_back(edge.low, edge.high);
        pairs.emplace_back(edge.high, edge.low);
    }
    return rows_from_pairs(welded.size(), pairs);
}

std::vector<std::uint32_t> connected_components(const Adjacency& adjacency) {
    const std::size_t count = adjacency.first.empty() ? 0 : adjacency.first.size() - 1;
    std::vector<std::uint32_t> component(count, ~0u), stack;
    std::uint32_t next = 0;
    for (std::size_t start = 0; start < count; ++start) {
        if (component[start] != ~0u)
            continue;
        component[start] = next;
        stack.push_back(std::uint32_t(start));
        while (!stack.empty()) {
            const std::uint32_t item = stack.back();
            stack.pop_back();
            for (const std::uint32_t neighbour : adjacency.of(item))
                if (component[neighbour] == ~0u) {
                    component[neighbour] = next;
                    stack.push_back(neighbour);
                }
        }
        ++next;
    }
    return component;
}

} // namespace kokage

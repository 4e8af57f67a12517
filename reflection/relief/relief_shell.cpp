#include "reflection/relief/relief_shell.h"
#include "common/services/error.h"
#include "reflection/relief/tangent_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

namespace kokage {
namespace {

using Prism = ReliefShell::Prism;

constexpr std::array<std::array<std::size_t, 2>, 3> kSides{{{0, 1}, {0, 2}, {1, 2}}};

std::vector<glm::vec3> place_normals(const ReliefMesh& mesh, const WeldedPlaces& places) {
    std::vector<glm::dvec3> sums(places.count);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        sums[places.place_of_vertex[i]] += glm::dvec3(mesh.normals[i]);
    std::vector<glm::vec3> normals(places.count, glm::vec3(0.f));
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (const double length = glm::length(sums[i]); length > 1e-6)
            normals[i] = glm::vec3(sums[i] / length);
    return normals;
}

/// Reciprocal of the greatest curvature of what is convex, from how normals turn along the edges; infinity where flat.
std::vector<float> convex_radii(const ReliefShell& shell, const std::vector<glm::vec3>& normals) {
    std::vector<float> curvatures(normals.size(), 0.f);
    for (const Prism& prism : shell.prisms)
        for (const auto& [k, l] : kSides) {
            const std::uint32_t i = prism.places[k], j = prism.places[l];
            const glm::vec3 edge = shell.outer[j] - shell.outer[i];
            const float squared = glm::dot(edge, edge);
            if (squared <= 0)
                continue;
            const float curvature = glm::dot(normals[j] - normals[i], edge) / squared;
            curvatures[i] = std::max(curvatures[i], curvature);
            curvatures[j] = std::max(curvatures[j], curvature);
        }
    std::vector<float> radii;
    for (const float c : curvatures)
        radii.push_back(c > 0 ? 1 / c : std::numeric_limits<float>::infinity());
    return radii;
}

/// Six times the volumes of the prism's tetrahedra, the one that stands on corner k's column at k.
std::array<double, 3> volumes(const ReliefShell& shell, const Prism& prism) {
    const auto a = [&](std::size_t k) { return glm::dvec3(shell.outer[prism.places[k]]); };
    const auto b = [&](std::size_t k) { return glm::dvec3(shell.inner[prism.places[k]]); };
    const auto volume = [](const glm::dvec3& o, const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
        return glm::dot(glm::cross(p - o, q - o), r - o);
    };
    return {-volume(b(0), b(1), b(2), a(0)), volume(a(0), a(1), b(2), b(1)), volume(a(0), a(1), a(2), b(2))};
}

/// True where all tetrahedra stand the same way up, with room between top and bottom.
bool stands(const ReliefShell& shell, const Prism& prism) {
    const auto a = [&](std::size_t k) { return glm::dvec3(shell.outer[prism.places[k]]); };
    const glm::dvec3 area = glm::cross(a(1) - a(0), a(2) - a(0));
    double longest = 0;
    for (const auto& [k, l] : kSides)
        longest = std::max(longest, glm::distance(a(k), a(l)));
    if (!(glm::length(area) > 1e-7 * longest * longest))
        return false;
    // Downwards is inside: which sign that is depends on how the corners were sorted.
    const bool odd = (prism.corners[1] + 3 - prism.corners[0]) % 3 != 1;
    const std::array<double, 3> sixfold = volumes(shell, prism);
    for (std::size_t k = 0; k < 3; ++k) {
        const double upright = glm::length(area) * glm::distance(a(k), glm::dvec3(shell.inner[prism.places[k]]));
        if (!(upright > 0) || !((odd ? sixfold[k] : -sixfold[k]) > 0.02 * upright))
            return false;
    }
    return true;
}

/// Shrinks depth where prisms fold, then calls what still does not stand solid.
void unfold(ReliefShell& shell, const std::vector<bool>& solid_layers) {
    std::vector<bool> shallow(shell.outer.size(), false);
    constexpr int kRounds = 12;
    for (int round = 0; round <= kRounds; ++round) {
        std::vector<bool> shrink(shell.outer.size(), false);
        for (Prism& prism : shell.prisms) {
            if (solid_layers[prism.layer])
                continue;
            prism.is_solid = !stands(shell, prism);
            for (std::size_t k = 0; k < 3 && prism.is_solid; ++k)
                shrink[prism.places[k]] = true;
        }
        for (std::size_t i = 0; i < shrink.size() && round < kRounds; ++i)
            if (shrink[i]) {
                shell.inner[i] = 0.4f * shell.outer[i] + 0.6f * shell.inner[i];
                shallow[i] = true;
            }
    }
    shell.shallow_places = std::size_t(std::count(shallow.begin(), shallow.end(), true));
}

/// Whether a prism's side runs along its triangle's winding.
bool runs_forward(const Prism& prism, std::size_t side) {
    const auto& [k, l] = kSides[side];
    return (prism.corners[l] + 3 - prism.corners[k]) % 3 == 1;
}

bool is_collapsed(const Prism& prism) {
    return prism.places[0] == prism.places[1] || prism.places[1] == prism.places[2];
}

/// Sides that two triangles share, each running along it the other way, are common; all others are borders.
void find_neighbors(ReliefShell& shell) {
    struct Users {
        std::uint32_t first = ReliefShell::kBorder, second = ReliefShell::kBorder;
        int count = 0;
    };
    std::unordered_map<std::uint64_t, Users> users(shell.prisms.size() * 2);
    for (std::uint32_t t = 0; t < shell.prisms.size(); ++t) {
        Prism& prism = shell.prisms[t];
        prism.neighbors.fill(ReliefShell::kBorder);
        if (is_collapsed(prism))
            continue;
        for (std::uint32_t side = 0; side < 3; ++side) {
            const auto& [k, l] = kSides[side];
            Users& u = users[std::uint64_t(prism.places[k]) << 32 | prism.places[l]];
            (u.count == 0 ? u.first : u.second) = t << 2 | side;
            ++u.count;
        }
    }
    for (const auto& [edge, u] : users) {
        if (u.count != 2)
            continue;
        Prism &p = shell.prisms[u.first >> 2], &q = shell.prisms[u.second >> 2];
        if (runs_forward(p, u.first & 3) == runs_forward(q, u.second & 3))
            continue;
        p.neighbors[u.first & 3] = u.second;
        q.neighbors[u.second & 3] = u.first;
    }
}

Prism sorted_prism(const ReliefMesh& mesh, const WeldedPlaces& places, const glm::uvec3& triangle) {
    Prism prism;
    std::array<std::uint8_t, 3> order{0, 1, 2};
    const auto place = [&](std::uint8_t k) { return places.place_of_vertex[triangle[k]]; };
    std::stable_sort(order.begin(), order.end(), [&](auto k, auto l) { return place(k) < place(l); });
    for (std::size_t k = 0; k < 3; ++k) {
        prism.places[k] = place(order[k]);
        prism.uvs[k] = mesh.uvs[triangle[order[k]]];
        prism.corners[k] = order[k];
    }
    return prism;
}

void check_layers(const ReliefLayers& layers, std::size_t triangles, std::string_view name) {
    const auto is_bad = [](float x) { return !(x >= 0) || !std::isfinite(x); };
    for (const ReliefDepth& depth : layers.depths)
        if (is_bad(depth.depth_m) || is_bad(depth.tile_m) || is_bad(depth.most_of_radius) ||
            depth.most_of_radius > 0.5f)
            throw InputError(std::string(name) + ": relief " + std::to_string(depth.depth_m) + " m deep on tiles of " +
                             std::to_string(depth.tile_m) + " m, at most " + std::to_string(depth.most_of_radius) +
                             " of the radius: all must be finite and at least 0, the last at most 0.5");
    const bool is_complete =
        layers.of_triangle.empty() ? !layers.depths.empty() : layers.of_triangle.size() == triangles;
    const auto is_known = [&](std::uint8_t layer) { return layer < layers.depths.size(); };
    if (!is_complete || !std::all_of(layers.of_triangle.begin(), layers.of_triangle.end(), is_known))
        throw InputError(std::string(name) + ": each of the " + std::to_string(triangles) +
                         " triangles must have one of " + std::to_string(layers.depths.size()) + " layers of relief");
}

/// How deep each place's shell shall be.
std::vector<float> place_depths(const ReliefMesh& mesh, const ReliefShell& shell, const WeldedPlaces& places,
                                const ReliefLayers& layers, const std::vector<glm::vec3>& normals) {
    const std::vector<float> radii = convex_radii(shell, normals), tiles = tile_sizes(mesh, places);
    std::vector<float> depths(places.count, std::numeric_limits<float>::infinity());
    for (const Prism& prism : shell.prisms) {
        const ReliefDepth& depth = layers.depths[prism.layer];
        for (std::size_t k = 0; k < 3 && depth.depth_m > 0; ++k) {
            const std::uint32_t i = prism.places[k];
            const float narrow = depth.tile_m > 0 && tiles[i] > 0 ? std::min(1.f, tiles[i] / depth.tile_m) : 1.f;
            depths[i] = std::min({depths[i], depth.depth_m * narrow, depth.most_of_radius * radii[i]});
        }
    }
    for (float& depth : depths)
        depth = std::isfinite(depth) ? depth : 0;
    return depths;
}

} // namespace

ReliefShell make_relief_shell(const ReliefMesh& mesh, const ReliefLayers& layers, std::string_view name) {
    check_relief_mesh(mesh, name);
    check_layers(layers, mesh.triangles.size(), name);
    if (mesh.triangles.size() >= ReliefShell::kBorder >> 2)
        throw InputError(std::string(name) + ": " + std::to_string(mesh.triangles.size()) +
                         " triangles are too many for relief");
    const WeldedPlaces places = weld_places(mesh.positions);
    ReliefShell shell;
    shell.outer.resize(places.count);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        shell.outer[places.place_of_vertex[i]] = mesh.positions[i];
    std::vector<bool> solid_layers;
    for (const ReliefDepth& depth : layers.depths)
        solid_layers.push_back(!(depth.depth_m > 0));
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        Prism prism = sorted_prism(mesh, places, mesh.triangles[t]);
        prism.layer = layers.of_triangle.empty() ? std::uint8_t(0) : layers.of_triangle[t];
        prism.is_solid = solid_layers[prism.layer];
        shell.prisms.push_back(prism);
    }
    find_neighbors(shell);
    const std::vector<glm::vec3> normals = place_normals(mesh, places);
    const std::vector<float> depths = place_depths(mesh, shell, places, layers, normals);
    for (std::size_t i = 0; i < places.count; ++i)
        shell.inner.push_back(shell.outer[i] - depths[i] * normals[i]);
    unfold(shell, solid_layers);
    return shell;
}

ReliefShell make_relief_shell(const ReliefMesh& mesh, const ReliefDepth& depth, std::string_view name) {
    return make_relief_shell(mesh, ReliefLayers{{depth}, {}}, name);
}

float ReliefShell::thickness_m(const Prism& prism, const glm::vec3& weights) const {
    float sum = 0;
    for (std::size_t k = 0; k < 3; ++k)
        sum += weights[k] * glm::distance(outer[prism.places[k]], inner[prism.places[k]]);
    return sum;
}

std::size_t ReliefShell::bytes() const {
    return (outer.size() + inner.size()) * sizeof(glm::vec3) + prisms.size() * sizeof(Prism);
}

glm::dvec3 shell_point(const ReliefShell& shell, const ReliefShell::Prism& prism, const glm::dvec3& weights,
                       double depth) {
    const double b2 = std::min(depth, weights[2]), b1 = std::clamp(depth - weights[2], 0., weights[1]);
    const glm::dvec3 bottom(std::max(depth - weights[2] - weights[1], 0.), b1, b2);
    glm::dvec3 point(0.);
    for (std::size_t k = 0; k < 3; ++k)
        point += (weights[k] - bottom[k]) * glm::dvec3(shell.outer[prism.places[k]]) +
                 bottom[k] * glm::dvec3(shell.inner[prism.places[k]]);
    return point;
}

} // namespace kokage

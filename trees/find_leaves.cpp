#include "trees/find_leaves.h"

#include "common/geometry/point_tree.h"
#include "common/geometry/triangle_topology.h"
#include "trees/surface_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace kokage {
namespace {

constexpr float kLargestShare = 0.05f;     // of the crown's radius
constexpr float kLargestFlatShare = 0.15f; // likewise, for pieces that are as large as most are
constexpr double kFlat = 0.7;              // length of the mean normal; a closed surface has none
constexpr std::size_t kFewPieces = 20;     // say nothing about how large leaves are
constexpr float kSlender = 0.25f;          // a stalk's width over its length
constexpr float kTouch = 0.25f;            // of its width, between a stalk's end and its blade

/// A connected piece of foliage.
struct LeafPiece {
    glm::dvec3 normal_sum{0.0};
    double area = 0;
    glm::vec3 low{std::numeric_limits<float>::infinity()}, high{-std::numeric_limits<float>::infinity()};
    std::uint32_t triangles = 0, first_triangle = ~0u;

    bool flat() const { return glm::length(normal_sum) > kFlat * area; }
    float radius() const { return 0.5f * glm::distance(low, high); }
};

struct Pieces {
    std::vector<std::uint32_t> welded, of_triangle;
    std::vector<LeafPiece> pieces;
};

Pieces pieces_of(const SceneMesh& mesh) {
    Pieces result;
    result.welded = weld(mesh.positions);
    result.of_triangle = connected_components(triangle_neighbours(mesh.triangles, result.welded));
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        if (result.of_triangle[t] >= result.pieces.size())
            result.pieces.resize(result.of_triangle[t] + 1);
        LeafPiece& piece = result.pieces[result.of_triangle[t]];
        const glm::uvec3& corners = mesh.triangles[t];
        const glm::dvec3 a(mesh.positions[corners.x]), b(mesh.positions[corners.y]), c(mesh.positions[corners.z]);
        const glm::dvec3 normal = 0.5 * glm::cross(b - a, c - a);
        piece.normal_sum += normal;
        piece.area += glm::length(normal);
        for (int k = 0; k < 3; ++k) {
            piece.low = glm::min(piece.low, mesh.positions[corners[k]]);
            piece.high = glm::max(piece.high, mesh.positions[corners[k]]);
        }
        piece.first_triangle = std::min(piece.first_triangle, t);
        ++piece.triangles;
    }
    return result;
}

/// Nine in ten of the flat pieces are no larger, if there are enough. Only those count that show a leaf by their
/// outline: a texture with alpha may hold a whole bough.
float usual_radius(std::span<const SceneMesh> meshes, const std::vector<Pieces>& pieces,
                   std::span<const SceneMaterial> materials) {
    std::vector<float> radii;
    for (std::size_t m = 0; m < meshes.size(); ++m) {
        const SceneMaterial& material = materials[std::size_t(meshes[m].material)];
        if (material.alpha_mode != AlphaMode::opaque && material.base_color_texture &&
            material.base_color_texture->alpha)
            continue;
        for (const LeafPiece& piece : pieces[m].pieces)
            if (piece.triangles > 2 && piece.flat())
                radii.push_back(piece.radius());
    }
    if (radii.size() < kFewPieces)
        return 0;
    const auto ninth = radii.begin() + std::ptrdiff_t(radii.size() * 9 / 10);
    std::nth_element(radii.begin(), ninth, radii.end());
    return 1.25f * *ninth;
}

/// The ends of a piece of two triangles that is much longer than wide: the middles of its two short sides, and their
/// length.
struct Stalk {
    std::array<glm::vec3, 2> ends;
    float width = 0;
};

std::optional<Stalk> as_stalk(const SceneMesh& mesh, const Pieces& pieces, std::uint32_t first, std::uint32_t second) {
    struct Side {
        std::uint32_t a, b;
        float length;
    };
    std::vector<Side> sides; // those of one triangle alone
    for (const std::uint32_t t : {first, second})
        for (int c = 0; c < 3; ++c) {
            const std::uint32_t a = pieces.welded[mesh.triangles[t][c]],
                                b = pieces.welded[mesh.triangles[t][(c + 1) % 3]];
            const auto same = std::find_if(sides.begin(), sides.end(), [&](const Side& side) {
                return (side.a == a && side.b == b) || (side.a == b && side.b == a);
            });
            if (same != sides.end())
                sides.erase(same);
            else
                sides.push_back({a, b, glm::distance(mesh.positions[a], mesh.positions[b])});
        }
    if (sides.size() != 4)
        return std::nullopt;
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) { return a.length < b.length; });
    if (!(sides[1].length < kSlender * sides[2].length))
        return std::nullopt;
    Stalk stalk;
    for (std::size_t e = 0; e < 2; ++e)
        stalk.ends[e] = 0.5f * (mesh.positions[sides[e].a] + mesh.positions[sides[e].b]);
    stalk.width = sides[1].length;
    return stalk;
}

/// Pieces that are small enough, and nowhere turn by more than the limit from what they look like as a whole, are one
/// patch: where growing a patch begins must not decide whether it is cut.
void keep_whole(const SceneMesh& mesh, const Pieces& pieces, const SurfacePatchLimits& limits, float largest_radius,
                std::vector<std::uint32_t>& patch) {
    std::vector<bool> whole(pieces.pieces.size());
    for (std::size_t p = 0; p < whole.size(); ++p)
        whole[p] = pieces.pieces[p].flat() && pieces.pieces[p].radius() <= largest_radius;
    const double least = std::cos(double(limits.max_turn));
    for (std::size_t t = 0; t < patch.size(); ++t) {
        const std::uint32_t p = pieces.of_triangle[t];
        if (!whole[p])
            continue;
        const glm::uvec3& corners = mesh.triangles[t];
        const glm::dvec3 a(mesh.positions[corners.x]), b(mesh.positions[corners.y]), c(mesh.positions[corners.z]);
        const glm::dvec3 normal = glm::cross(b - a, c - a);
        const glm::dvec3& mean = pieces.pieces[p].normal_sum;
        whole[p] = glm::dot(normal, mean) >= least * glm::length(normal) * glm::length(mean);
    }
    for (std::size_t t = 0; t < patch.size(); ++t)
        if (const std::uint32_t p = pieces.of_triangle[t]; whole[p])
            patch[t] = patch[pieces.pieces[p].first_triangle];
}

/// Gives stalks the patch of their blades. Returns how many.
std::size_t join_stalks(const SceneMesh& mesh, const Pieces& pieces, std::vector<std::uint32_t>& patch) {
    std::vector<std::array<std::uint32_t, 2>> of_card(pieces.pieces.size(), {~0u, ~0u});
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (const std::uint32_t p = pieces.of_triangle[t]; pieces.pieces[p].triangles == 2)
            of_card[p][of_card[p][0] == ~0u ? 0 : 1] = t;
    std::vector<std::pair<std::uint32_t, Stalk>> stalks; // the piece
    std::vector<bool> is_stalk(pieces.pieces.size(), false);
    for (std::uint32_t p = 0; p < of_card.size(); ++p)
        if (of_card[p][1] != ~0u)
            if (const std::optional<Stalk> stalk = as_stalk(mesh, pieces, of_card[p][0], of_card[p][1])) {
                stalks.emplace_back(p, *stalk);
                is_stalk[p] = true;
            }
    if (stalks.empty() || stalks.size() == pieces.pieces.size())
        return 0;
    std::vector<std::uint32_t> triangle_at(mesh.positions.size(), ~0u); // of blades, per corner
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
        if (!is_stalk[pieces.of_triangle[t]])
            for (int c = 0; c < 3; ++c) {
                std::uint32_t& at = triangle_at[pieces.welded[mesh.triangles[t][c]]];
                at = std::min(at, t);
            }
    std::vector<glm::vec3> corners;
    std::vector<std::uint32_t> triangles;
    for (std::size_t v = 0; v < triangle_at.size(); ++v)
        if (triangle_at[v] != ~0u) {
            corners.push_back(mesh.positions[v]);
            triangles.push_back(triangle_at[v]);
        }
    const PointTree blades(corners);
    std::size_t joined = 0;
    for (const auto& [piece, stalk] : stalks) {
        const std::array<NearestPoint, 2> near{blades.nearest(stalk.ends[0]), blades.nearest(stalk.ends[1])};
        const NearestPoint& nearest = near[1].distance < near[0].distance ? near[1] : near[0];
        if (!nearest.found() || nearest.distance > kTouch * stalk.width)
            continue;
        for (const std::uint32_t t : of_card[piece])
            patch[t] = patch[triangles[nearest.index]];
        ++joined;
    }
    return joined;
}

/// Numbers from `first` on, by their first triangle; returns the next free one.
std::uint32_t renumber(std::vector<std::uint32_t>& patch, std::uint32_t first) {
    std::vector<std::uint32_t> number;
    for (std::uint32_t& p : patch) {
        if (p >= number.size())
            number.resize(p + 1, ~0u);
        if (number[p] == ~0u)
            number[p] = first++;
        p = number[p];
    }
    return first;
}

} // namespace

FoundLeaves find_leaves(std::span<const SceneMesh> foliage, std::span<const SceneMaterial> materials, float leaf_size,
                        float crown_radius_m, Progress& progress) {
    progress.begin("finding leaves", 2 * foliage.size());
    std::vector<Pieces> pieces;
    for (const SceneMesh& mesh : foliage) {
        progress.throw_if_stopped();
        pieces.push_back(pieces_of(mesh));
        progress.advance(1);
    }
    FoundLeaves found;
    found.largest_radius_m = leaf_size;
    if (!(leaf_size > 0))
        found.largest_radius_m =
            std::max(kLargestShare * crown_radius_m,
                     std::min(usual_radius(foliage, pieces, materials), kLargestFlatShare * crown_radius_m));
    SurfacePatchLimits limits;
    limits.max_radius = [&](const glm::vec3&) { return found.largest_radius_m; };
    for (std::size_t m = 0; m < foliage.size(); ++m) {
        progress.throw_if_stopped();
        std::vector<std::uint32_t> patch = surface_patches(foliage[m].positions, foliage[m].triangles, limits);
        keep_whole(foliage[m], pieces[m], limits, found.largest_radius_m, patch);
        found.stalks += join_stalks(foliage[m], pieces[m], patch);
        found.count = renumber(patch, found.count);
        found.leaf_of.push_back(std::move(patch));
        progress.advance(1);
    }
    return found;
}

} // namespace kokage

#include "trees/coarse_bark.h"

#include "common/geometry/point_tree.h"
#include "common/geometry/triangle_topology.h"
#include "common/services/random.h"
#include "trees/keep_bark_area.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <meshoptimizer.h>
#include <numeric>
#include <set>

namespace kokage {
namespace {

/// A connected piece of bark: on a grown tree, a branch.
struct Piece {
    std::size_t part = 0;
    std::vector<std::uint32_t> triangles;
    double area = 0, volume = 0;
    /// Radius of the tube that has this volume and surface; pieces that are not closed are thick as they are large.
    double thickness() const {
        const double from_volume = area > 0 ? 2 * std::abs(volume) / area : 0;
        return std::min(from_volume, std::sqrt(area));
    }
};

void add_pieces(const TreePart& bark, std::size_t part, std::vector<Piece>& all) {
    const std::vector<std::uint32_t> component =
        connected_components(triangle_neighbours(bark.triangles, weld(bark.positions)));
    std::vector<Piece> pieces(component.empty() ? 0 : *std::max_element(component.begin(), component.end()) + 1u);
    for (Piece& piece : pieces)
        piece.part = part;
    std::vector<glm::dvec3> origin(pieces.size(), glm::dvec3(0.0));
    for (std::size_t t = 0; t < component.size(); ++t) {
        Piece& piece = pieces[component[t]];
        const glm::dvec3 a(bark.positions[bark.triangles[t].x]), b(bark.positions[bark.triangles[t].y]),
            c(bark.positions[bark.triangles[t].z]);
        if (piece.triangles.empty())
            origin[component[t]] = a;
        const glm::dvec3 o = origin[component[t]];
        piece.triangles.push_back(std::uint32_t(t));
        piece.area += 0.5 * glm::length(glm::cross(b - a, c - a));
        piece.volume += glm::dot(a - o, glm::cross(b - o, c - o)) / 6;
    }
    std::move(pieces.begin(), pieces.end(), std::back_inserter(all));
}

/// Which triangles of a part stay: whole pieces, and others to be simplified.
struct Kept {
    std::vector<std::uint32_t> whole, reduced;
};

/// Of all parts together: whole pieces, the thickest, until they have `most_whole` triangles; further pieces, the
/// thickest or `at_random`, until there are `most` in all.
std::vector<Kept> choose_pieces(const std::vector<Piece>& pieces, std::size_t parts, std::size_t most_whole,
                                std::size_t most, bool at_random) {
    std::vector<std::size_t> order(pieces.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return pieces[a].thickness() > pieces[b].thickness(); });
    std::size_t taken = 0, whole = 0;
    while (whole < order.size() && taken + pieces[order[whole]].triangles.size() <= most_whole)
        taken += pieces[order[whole++]].triangles.size();
    if (at_random) {
        // The same throw for every level: a coarser one has no twig that a finer one lacks, but for those kept whole.
        std::vector<double> lot(pieces.size());
        for (std::size_t i = 0; i < lot.size(); ++i)
            lot[i] = Random(0x7716u, i).uniform();
        std::stable_sort(order.begin() + std::ptrdiff_t(whole), order.end(),
                         [&](std::size_t a, std::size_t b) { return lot[a] < lot[b]; });
    }
    std::vector<Kept> kept(parts);
    taken = 0;
    for (std::size_t k = 0; k < order.size(); ++k) {
        const Piece& piece = pieces[order[k]];
        if (k >= whole && taken > 0 && taken + piece.triangles.size() > most)
            break;
        taken += piece.triangles.size();
        std::vector<std::uint32_t>& where = k < whole ? kept[piece.part].whole : kept[piece.part].reduced;
        where.insert(where.end(), piece.triangles.begin(), piece.triangles.end());
    }
    for (Kept& own : kept) {
        std::sort(own.whole.begin(), own.whole.end());
        std::sort(own.reduced.begin(), own.reduced.end());
    }
    return kept;
}

/// The part's triangles `kept`, with about `target` of them left after edge collapses. Corners are the part's vertices.
std::vector<glm::uvec3> simplified(const TreePart& fine, const std::vector<std::uint32_t>& kept, std::size_t target) {
    if (kept.empty())
        return {};
    std::vector<std::uint32_t> indices;
    indices.reserve(kept.size() * 3);
    for (const std::uint32_t t : kept)
        for (std::size_t c = 0; c < 3; ++c)
            indices.push_back(fine.triangles[t][c]);
    std::vector<std::uint32_t> result(indices.size());
    // No limit on the error: what has the least goes first, and the count decides.
    result.resize(meshopt_simplify(result.data(), indices.data(), indices.size(), &fine.positions[0].x,
                                   fine.positions.size(), sizeof(glm::vec3), target * 3, 1.f, 0, nullptr));
    std::vector<glm::uvec3> triangles(result.size() / 3);
    for (std::size_t t = 0; t < triangles.size(); ++t)
        triangles[t] = {result[3 * t], result[3 * t + 1], result[3 * t + 2]};
    return triangles;
}

/// Area centroids of the patches of some triangles.
std::map<std::uint32_t, glm::vec3> patch_centres(const TreePart& part, const std::vector<std::uint32_t>& triangles) {
    std::map<std::uint32_t, std::pair<glm::dvec3, double>> sums;
    for (const std::uint32_t t : triangles) {
        const glm::dvec3 a(part.positions[part.triangles[t].x]), b(part.positions[part.triangles[t].y]),
            c(part.positions[part.triangles[t].z]);
        const double area = glm::length(glm::cross(b - a, c - a)) + 1e-30;
        auto& [sum, weight] = sums[part.triangle_patch[t]];
        sum += area * (a + b + c) / 3.0;
        weight += area;
    }
    std::map<std::uint32_t, glm::vec3> centres;
    for (const auto& [patch, sum] : sums)
        centres[patch] = glm::vec3(sum.first / sum.second);
    return centres;
}

/// A part of the triangles, sorted by patch; `patch_of` names each one's coarse patch. The first `growing` may grow
/// where their vertices are `thin`.
GrowingBark assemble(const TreePart& fine, const std::vector<glm::uvec3>& triangles,
                     const std::vector<std::uint32_t>& patch_of, std::size_t growing,
                     const std::vector<std::uint8_t>& thin) {
    GrowingBark bark;
    TreePart& part = bark.part;
    part.kind = TreePartKind::bark;
    part.material = fine.material;
    std::vector<std::uint32_t> order(triangles.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return patch_of[a] < patch_of[b]; });
    std::vector<std::uint32_t> index(fine.positions.size(), ~0u);
    for (const std::uint32_t t : order) {
        glm::uvec3 corners = triangles[t];
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t vertex = corners[c];
            if (index[vertex] == ~0u) {
                index[vertex] = std::uint32_t(part.positions.size());
                part.positions.push_back(fine.positions[vertex]);
                part.normals.push_back(fine.normals[vertex]);
                if (!fine.uvs.empty())
                    part.uvs.push_back(fine.uvs[vertex]);
            }
            corners[c] = index[vertex];
        }
        part.triangles.push_back(corners);
        part.triangle_patch.push_back(patch_of[t]);
        bark.may_grow.push_back(t < growing ? thin[triangles[t].x] : std::uint8_t(0));
    }
    return bark;
}

/// One part with what stays of it, its triangles in `bark`; `target`: how many are to be left of those to be
/// simplified.
CoarseBark coarse_part(const TreePart& fine, const Kept& chosen, std::size_t target,
                       const std::vector<std::uint8_t>& thin, GrowingBark& bark) {
    CoarseBark result;
    // Straight thick wood would lose all its rings, and with them the course of light along it: it stays as it is.
    std::vector<glm::uvec3> triangles = simplified(fine, chosen.reduced, target);
    const std::size_t growing = triangles.size();
    for (const std::uint32_t t : chosen.whole)
        triangles.push_back(fine.triangles[t]);
    std::vector<std::uint32_t> kept = chosen.whole;
    kept.insert(kept.end(), chosen.reduced.begin(), chosen.reduced.end());
    std::sort(kept.begin(), kept.end());

    // A triangle goes to the patch that its first corner was in; what no triangle is left of, to the nearest that has.
    std::vector<std::uint32_t> patch_of_vertex(fine.positions.size(), ~0u);
    for (const std::uint32_t t : kept)
        for (std::size_t c = 0; c < 3; ++c)
            if (patch_of_vertex[fine.triangles[t][c]] == ~0u)
                patch_of_vertex[fine.triangles[t][c]] = fine.triangle_patch[t];
    std::map<std::uint32_t, std::uint32_t> number; // of fine patches that stay
    for (const glm::uvec3& t : triangles)
        number.try_emplace(patch_of_vertex[t.x], 0u);
    for (auto& [patch, own] : number)
        own = result.patches++;
    std::vector<std::uint32_t> patch_of;
    for (const glm::uvec3& t : triangles)
        patch_of.push_back(number.at(patch_of_vertex[t.x]));
    const std::map<std::uint32_t, glm::vec3> centres = patch_centres(fine, kept);
    std::vector<glm::vec3> places;
    std::vector<std::uint32_t> numbers;
    std::set<std::uint32_t> untouched;
    for (const std::uint32_t t : chosen.whole)
        untouched.insert(fine.triangle_patch[t]);
    for (const auto& [patch, own] : number)
        if (!untouched.contains(patch)) { // the others have all of their own light
            places.push_back(centres.at(patch));
            numbers.push_back(own);
        }
    const PointTree nearest(places, numbers);
    for (std::size_t t = 0; t < fine.triangles.size(); ++t) {
        const std::uint32_t patch = fine.triangle_patch[t];
        if (t > 0 && patch == fine.triangle_patch[t - 1])
            continue;
        const auto own = number.find(patch);
        const auto centre = centres.find(patch);
        result.stands_for.emplace_back(patch, own != number.end() ? own->second
                                              : centre == centres.end() || places.empty()
                                                  ? ~0u
                                                  : nearest.nearest(centre->second).index);
    }
    bark = assemble(fine, triangles, patch_of, growing, thin);
    return result;
}

} // namespace

std::vector<CoarseBark> coarse_bark(const std::vector<const TreePart*>& fine, double share, bool bare) {
    std::vector<Piece> pieces;
    std::size_t count = 0;
    for (std::size_t p = 0; p < fine.size(); ++p) {
        add_pieces(*fine[p], p, pieces);
        count += fine[p]->triangles.size();
    }
    const std::size_t target = std::max<std::size_t>(16, std::size_t(std::lround(double(count) * share)));
    const std::vector<Kept> kept = choose_pieces(pieces, fine.size(), target / 2, 2 * target, bare);
    std::size_t whole = 0, reduced = 0;
    for (const Kept& own : kept) {
        whole += own.whole.size();
        reduced += own.reduced.size();
    }
    const double left = reduced ? std::min(1.0, double(target - std::min(target, whole)) / double(reduced)) : 0;
    double area = 0, thickest = 0;
    for (const Piece& piece : pieces) {
        area += piece.area;
        thickest = std::max(thickest, piece.thickness());
    }
    // A trunk twice as thick would be seen: wood may grow that is thinner than half of the thickest.
    std::vector<std::vector<std::uint8_t>> thin(fine.size());
    for (std::size_t p = 0; p < fine.size(); ++p)
        thin[p].assign(fine[p]->positions.size(), 0);
    for (const Piece& piece : pieces)
        if (2 * piece.thickness() < thickest)
            for (const std::uint32_t t : piece.triangles)
                for (int c = 0; c < 3; ++c)
                    thin[piece.part][fine[piece.part]->triangles[t][c]] = 1;
    std::vector<CoarseBark> result;
    std::vector<GrowingBark> bark(fine.size());
    for (std::size_t p = 0; p < fine.size(); ++p)
        result.push_back(coarse_part(*fine[p], kept[p], std::size_t(std::lround(left * double(kept[p].reduced.size()))),
                                     thin[p], bark[p]));
    keep_bark_area(bark, area, 4 * thickest);
    for (std::size_t p = 0; p < fine.size(); ++p)
        result[p].part = std::move(bark[p].part);
    return result;
}

} // namespace kokage

#include "trees/growth/bark_zones.h"

#include "common/services/random.h"
#include "trees/growth/streams.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kokage {
namespace {

/// Up to which share of the tree's height its trunk has changed from old bark to young: birches are black at the very
/// foot, pines plated to about a third (field guides' pictures; no measured source).
struct Ageing {
    float old_below, young_above;
};
std::optional<Ageing> ageing(BarkKind kind) {
    switch (kind) {
    case BarkKind::birch:
        return Ageing{0.01f, 0.13f};
    case BarkKind::aspen:
        return Ageing{0.02f, 0.28f};
    case BarkKind::pine:
        return Ageing{0.10f, 0.42f};
    default:
        return std::nullopt;
    }
}

/// Steps from young bark to old: from one to the next few of a pine's plates fall.
constexpr float age_steps = 6;
/// All wood but twigs, where it does not age: grown-up, not ancient.
constexpr float common_age = 0.7f;
constexpr float thickest_twig_m = 0.012f, thickest_twig_share = 0.16f;

/// A part without those vertices that no triangle uses.
TreePart with_triangles(const TreePart& bark, const std::vector<std::uint32_t>& triangles) {
    TreePart part;
    part.kind = bark.kind;
    std::vector<std::uint32_t> index(bark.positions.size(), ~0u);
    for (const std::uint32_t t : triangles) {
        glm::uvec3 corners = bark.triangles[t];
        for (std::size_t c = 0; c < 3; ++c) {
            const std::uint32_t vertex = corners[c];
            if (index[vertex] == ~0u) {
                index[vertex] = std::uint32_t(part.positions.size());
                part.positions.push_back(bark.positions[vertex]);
                part.normals.push_back(bark.normals[vertex]);
                part.uvs.push_back(bark.uvs[vertex]);
            }
            corners[c] = index[vertex];
        }
        part.triangles.push_back(corners);
        part.triangle_patch.push_back(bark.triangle_patch[t]);
    }
    return part;
}

} // namespace

BarkZone bark_zone(const BarkPlace& place, const GrowthParameters& p, float trunk_radius_m, float tree_height_m,
                   std::uint32_t patch) {
    if (place.radius_m < thickest_twig_m && place.radius_m < thickest_twig_share * trunk_radius_m)
        return {.is_twig = true, .age = 0};
    const std::optional<Ageing> change = ageing(p.bark);
    if (!change)
        return {.is_twig = false, .age = common_age};
    if (!place.on_trunk)
        return {.is_twig = false, .age = 0};
    Random random(p.seed, streams::of(streams::bark_zone, patch));
    const float height = place.height_m / std::max(tree_height_m, 1e-6f) * random.uniform(0.95f, 1.05f);
    const float age = (change->young_above - height) / (change->young_above - change->old_below);
    return {.is_twig = false, .age = std::clamp(std::round(age_steps * age), 0.f, age_steps) / age_steps};
}

BarkInZones split_by_zone(const TreePart& bark, const std::vector<BarkPlace>& places, const GrowthParameters& p) {
    BarkInZones result;
    float trunk_radius = 0, height = 0;
    for (const BarkPlace& place : places) {
        trunk_radius = std::max(trunk_radius, place.radius_m);
        height = std::max(height, place.height_m);
    }
    std::vector<std::vector<std::uint32_t>> triangles;
    std::vector<std::size_t> zone_of_patch(places.size());
    for (std::size_t patch = 0; patch < places.size(); ++patch) {
        const BarkZone zone = bark_zone(places[patch], p, trunk_radius, height, std::uint32_t(patch));
        const auto found = std::find(result.zones.begin(), result.zones.end(), zone);
        zone_of_patch[patch] = std::size_t(found - result.zones.begin());
        if (found == result.zones.end())
            result.zones.push_back(zone);
    }
    triangles.resize(result.zones.size());
    for (std::size_t t = 0; t < bark.triangles.size(); ++t)
        triangles[zone_of_patch[bark.triangle_patch[t]]].push_back(std::uint32_t(t));
    for (const std::vector<std::uint32_t>& own : triangles)
        result.parts.push_back(with_triangles(bark, own));
    return result;
}

} // namespace kokage

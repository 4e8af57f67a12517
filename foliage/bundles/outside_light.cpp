#include "foliage/bundles/outside_light.h"

#include "common/services/parallel.h"
#include "foliage/bundles/end_gather.h"
#include "foliage/bundles/ray_ends.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace kokage::bundles {
namespace {

constexpr std::size_t kPatchBlock = 1 << 15; // waking a thread for less costs more than it saves

EndSums operator+(const EndSums& a, const EndSums& b) {
    EndSums sum;
    sum.weight = a.weight + b.weight;
    sum.front_open = a.front_open + b.front_open;
    sum.back_open = a.back_open + b.back_open;
    sum.front_down = a.front_down + b.front_down;
    sum.back_down = a.back_down + b.back_down;
    for (int c = 0; c < 3; ++c) {
        sum.front[c] = a.front[c] + b.front[c];
        sum.back[c] = a.back[c] + b.back[c];
    }
    return sum;
}

/// Means over a patch's facets, weighted by their area. Facets that no line met are left out.
void store_patch(const Facets& facets, std::span<const EndSums> sums, std::uint32_t patch, SkyLight::PerSide& out) {
    float area = 0, open[2] = {0, 0}, down[2] = {0, 0};
    glm::vec3 light[2] = {glm::vec3(0.f), glm::vec3(0.f)};
    for (std::uint32_t f = facets.patch_first_facet[patch]; f < facets.patch_first_facet[patch + 1]; ++f) {
        const EndSums& sum = sums[f];
        if (!(sum.weight > 0))
            continue;
        const float share = facets.facets[f].area / sum.weight;
        area += facets.facets[f].area;
        open[0] += share * sum.front_open;
        open[1] += share * sum.back_open;
        down[0] += share * sum.front_down;
        down[1] += share * sum.back_down;
        light[0] += share * glm::vec3(sum.front[0], sum.front[1], sum.front[2]);
        light[1] += share * glm::vec3(sum.back[0], sum.back[1], sum.back[2]);
    }
    const float inverse = area > 0 ? 1 / area : 0.f;
    for (int k = 0; k < 2; ++k) {
        const Side side = 2 * patch + k;
        out.open[side] = std::min(open[k] * inverse, 1.f);
        out.down[side] = std::min(down[k] * inverse, 1.f);
        out.irradiance[side] = Rgb::from(kPi * inverse * light[k]);
    }
}

/// A patch that no line met takes the light of the one before it, its neighbour on the branch.
void fill_unseen(const Facets& facets, std::span<const EndSums> sums, SkyLight::PerSide& out) {
    bool seen_before = false;
    for (std::uint32_t patch = 0; patch < facets.patch_count; ++patch) {
        float weight = 0;
        for (std::uint32_t f = facets.patch_first_facet[patch]; f < facets.patch_first_facet[patch + 1]; ++f)
            weight += sums[f].weight;
        if (weight > 0) {
            seen_before = true;
        } else if (seen_before) {
            for (Side side = 2 * patch; side < 2 * patch + 2; ++side) {
                out.irradiance[side] = out.irradiance[side - 2];
                out.open[side] = out.open[side - 2];
                out.down[side] = out.down[side - 2];
            }
        }
    }
}

void resize(SkyLight::PerSide& sides, std::size_t count) {
    sides.irradiance.resize(count);
    sides.open.resize(count);
    sides.down.resize(count);
}

/// Where there is a ground, all far ends are of its radiance.
SkyLight gather_outside(const Facets& facets, const BundleTransport& transport, const Image& remainder,
                        const glm::vec3& ground_radiance) {
    SkyLight sky;
    EndRadiance sky_ends = end_radiance(remainder, transport.sky_lines),
                link_ends = end_radiance(remainder, transport.link_lines);
    if (transport.ground) {
        std::fill(sky_ends.far_end.begin(), sky_ends.far_end.end(), ground_radiance);
        std::fill(link_ends.far_end.begin(), link_ends.far_end.end(), ground_radiance);
    }
    sky.near_radiance = link_ends.near_end;

    std::vector<EndSums> sums[2], all(facets.facets.size());
    for (int h = 0; h < 2; ++h) {
        sums[h].resize(facets.facets.size());
        auto gather = [&](const LineDirections& lines, const OpenFractions& open, const EndRadiance& ends) {
            const std::size_t first = h == 0 ? 0 : lines.half, last = h == 0 ? lines.half : lines.directions.size();
            gather_ends(facets, lines.directions, open, ends, first, last, sums[h]);
        };
        gather(transport.sky_lines, transport.sky_open, sky_ends);
        gather(transport.link_lines, transport.link_open, link_ends);
    }
    const std::size_t sides = 2 * std::size_t(facets.patch_count);
    for (SkyLight::PerSide* part : {&sky.halves[0], &sky.halves[1], &sky.all})
        resize(*part, sides);
    // A patch's facets are added up for each half and, the sums' sums, for all.
    parallel_blocks(std::size_t(facets.patch_count), kPatchBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t patch = from; patch < to; ++patch) {
            for (int h = 0; h < 2; ++h)
                store_patch(facets, sums[h], std::uint32_t(patch), sky.halves[h]);
            for (std::uint32_t f = facets.patch_first_facet[patch]; f < facets.patch_first_facet[patch + 1]; ++f)
                all[f] = sums[0][f] + sums[1][f];
            store_patch(facets, all, std::uint32_t(patch), sky.all);
        }
    });
    for (int h = 0; h < 2; ++h)
        fill_unseen(facets, sums[h], sky.halves[h]);
    fill_unseen(facets, all, sky.all);
    gather_ray_ends(transport, remainder, ground_radiance, sky);
    return sky;
}

} // namespace

glm::vec3 horizontal_irradiance(const Image& remainder) {
    glm::dvec3 sum(0.0);
    for (int y = 0; y < remainder.height; ++y) {
        // Integral of cos over a pixel's rows: exact, also where a row straddles the horizon.
        const double top = kPiDouble * y / remainder.height,
                     bottom = std::min(kPiDouble * (y + 1) / remainder.height, kPiDouble / 2);
        if (bottom <= top)
            break;
        const double weight =
            kPiDouble / remainder.width * (std::sin(bottom) * std::sin(bottom) - std::sin(top) * std::sin(top));
        for (int x = 0; x < remainder.width; ++x)
            sum += weight * glm::dvec3(remainder.at(x, y)[0], remainder.at(x, y)[1], remainder.at(x, y)[2]);
    }
    return glm::vec3(sum);
}

SkyLight gather_sky(const PatchScene& scene, const Facets& facets, const BundleTransport& transport,
                    const Image& remainder, const glm::vec3& light_on_open_ground) {
    if (!scene.ground)
        return gather_outside(facets, transport, remainder, glm::vec3(0.f));
    const glm::vec3 irradiance = horizontal_irradiance(remainder);
    SkyLight sky =
        gather_outside(facets, transport, remainder, scene.ground->albedo / kPi * (irradiance + light_on_open_ground));
    sky.open_ground_irradiance = irradiance;
    return sky;
}

SideLight gather_sky_alone(const Facets& facets, const BundleTransport& transport, const Image& remainder) {
    return gather_outside(facets, transport, remainder, glm::vec3(0.f)).all;
}

std::vector<glm::vec3> mean_open_directions(const Facets& facets, const BundleTransport& transport) {
    // Gathering "radiance" that is the direction it comes from gives the mean open direction.
    std::vector<EndSums> sums(facets.facets.size());
    for (auto [lines, open] : {std::pair(&transport.sky_lines, &transport.sky_open),
                               std::pair(&transport.link_lines, &transport.link_open)}) {
        EndRadiance directions{lines->directions, lines->directions};
        for (glm::vec3& up : directions.near_end)
            up = -up;
        if (transport.ground) // below is ground, not sky
            std::fill(directions.far_end.begin(), directions.far_end.end(), glm::vec3(0.f));
        gather_ends(facets, lines->directions, *open, directions, 0, lines->directions.size(), sums);
    }
    std::vector<glm::vec3> means(facets.patch_count, glm::vec3(0.f));
    for (std::size_t f = 0; f < sums.size(); ++f)
        if (sums[f].weight > 0)
            means[facets.facets[f].patch] +=
                facets.facets[f].area / sums[f].weight *
                glm::vec3(sums[f].front[0] + sums[f].back[0], sums[f].front[1] + sums[f].back[1],
                          sums[f].front[2] + sums[f].back[2]);
    sum_ray_open_directions(transport.rays, facets, means);
    for (std::uint32_t patch = 0; patch < facets.patch_count; ++patch) {
        const float length = glm::length(means[patch]);
        means[patch] = length > 1e-6f * facets.patch_area[patch] && length > 0 ? means[patch] / length : glm::vec3(0.f);
    }
    return means;
}

} // namespace kokage::bundles

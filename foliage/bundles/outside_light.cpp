#include "foliage/bundles/outside_light.h"

#include "common/services/parallel.h"
#include "foliage/bundles/end_gather.h"

#include <algorithm>
#include <cmath>

namespace kokage::bundles {
namespace {

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
    SkyLight sky;
    EndRadiance sky_ends = end_radiance(remainder, transport.sky_lines),
                link_ends = end_radiance(remainder, transport.link_lines);
    if (scene.ground) {
        sky.open_ground_irradiance = horizontal_irradiance(remainder);
        const glm::vec3 ground_radiance =
            scene.ground->albedo / kPi * (sky.open_ground_irradiance + light_on_open_ground);
        std::fill(sky_ends.far_end.begin(), sky_ends.far_end.end(), ground_radiance);
        std::fill(link_ends.far_end.begin(), link_ends.far_end.end(), ground_radiance);
    }
    sky.near_radiance = link_ends.near_end;

    std::vector<EndSums> sums[2];
    for (int h = 0; h < 2; ++h) {
        sums[h].resize(facets.facets.size());
        auto gather = [&](const LineDirections& lines, const OpenFractions& open, const EndRadiance& ends) {
            const std::size_t first = h == 0 ? 0 : lines.half, last = h == 0 ? lines.half : lines.directions.size();
            gather_ends(facets, lines.directions, open, ends, first, last, sums[h]);
        };
        gather(transport.sky_lines, transport.sky_open, sky_ends);
        gather(transport.link_lines, transport.link_open, link_ends);
    }
    const std::size_t sides = 2 * scene.patches.size();
    for (SkyLight::PerSide* part : {&sky.halves[0], &sky.halves[1], &sky.all})
        resize(*part, sides);
    parallel_blocks(scene.patches.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t patch = from; patch < to; ++patch)
            for (int h = 0; h < 2; ++h)
                store_patch(facets, sums[h], std::uint32_t(patch), sky.halves[h]);
    });
    for (int h = 0; h < 2; ++h)
        fill_unseen(facets, sums[h], sky.halves[h]);
    parallel_blocks(sums[0].size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f)
            sums[0][f] = sums[0][f] + sums[1][f];
    });
    parallel_blocks(scene.patches.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t patch = from; patch < to; ++patch)
            store_patch(facets, sums[0], std::uint32_t(patch), sky.all);
    });
    fill_unseen(facets, sums[0], sky.all);
    return sky;
}

void add_beams(const Facets& facets, const LitBeams& light, BeamLight& sum) {
    const std::size_t count = light.beams.size();
    parallel_blocks(facets.facets.size(), 4096, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            const Facet& facet = facets.facets[f];
            const float share = facet.area / facets.patch_area[facet.patch];
            for (std::size_t beam = 0; beam < count; ++beam) {
                const std::uint8_t open = light.visibility.open.near_row(beam)[f];
                if (open == 0 || open == OpenFractions::kUnseen)
                    continue;
                const glm::vec3& to_light = light.beams[beam].direction_to_light;
                Side side = 2 * facet.patch;
                float projected = 0;
                if (facet.bark) {
                    projected = facet.projected_share(to_light);
                } else {
                    const float cosine = glm::dot(facet.normal, to_light);
                    projected = std::abs(cosine);
                    side += cosine < 0;
                }
                const float weight = share * projected * float(open) / 254;
                Rgb& target = sum.halves[beam & 1][side];
                target.r += weight * light.beams[beam].irradiance.x;
                target.g += weight * light.beams[beam].irradiance.y;
                target.b += weight * light.beams[beam].irradiance.z;
            }
        }
    });
    for (std::size_t beam = 0; beam < count; ++beam) {
        const glm::vec3 on_ground =
            0.5f * light.beams[beam].irradiance * std::max(light.beams[beam].direction_to_light.y, 0.f);
        sum.open_ground += on_ground;
        if (!light.visibility.ground_shadow.empty())
            for (std::size_t texel = 0; texel < sum.ground.size(); ++texel)
                sum.ground[texel] += (1 - light.visibility.ground_shadow[beam][texel]) * on_ground;
    }
}

} // namespace kokage::bundles

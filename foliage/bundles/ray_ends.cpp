#include "foliage/bundles/ray_ends.h"

#include "common/services/parallel.h"

#include <algorithm>

namespace kokage::bundles {
namespace {

constexpr std::size_t kRayBlock = 1024;

} // namespace

void gather_ray_ends(const BundleTransport& transport, const Image& remainder, const glm::vec3& ground_radiance,
                     SkyLight& sky) {
    const RayLinks& rays = transport.rays;
    if (rays.empty())
        return;
    std::vector<glm::vec3> radiance = cell_means(rays.sky_cells, remainder);
    std::vector<std::uint8_t> down;
    for (const glm::vec3& direction : rays.sky_cells.directions)
        down.push_back(direction.y < 0);
    if (transport.ground) {
        radiance.resize(radiance.size() + transport.ground->texels() + 1, ground_radiance);
        down.resize(radiance.size(), 1);
    }
    parallel_blocks(rays.patches.size(), kRayBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t row = 4 * from; row < 4 * to; ++row) {
            const Side side = 2 * rays.patches[row / 4] + Side(row / 2 % 2);
            glm::vec3 light(0.f);
            int down_ends = 0;
            const float share = 1 / float(std::max(rays.rays_of(row), 1u));
            for (std::uint16_t end : rays.ends_of(row)) {
                light += radiance[end];
                down_ends += down[end];
            }
            SkyLight::PerSide& half = sky.halves[row % 2];
            half.open[side] = share * float(rays.ends_of(row).size());
            half.down[side] = share * float(down_ends);
            half.irradiance[side] = Rgb::from(kPi * share * light);
            if (row % 2 == 0)
                continue;
            const SkyLight::PerSide& first = sky.halves[0];
            sky.all.open[side] = 0.5f * (first.open[side] + half.open[side]);
            sky.all.down[side] = 0.5f * (first.down[side] + half.down[side]);
            sky.all.irradiance[side] = Rgb::from(0.5f * (first.irradiance[side].vec() + half.irradiance[side].vec()));
        }
    });
}

void gather_ray_ground(const RayLinks& rays, std::span<const glm::vec3> ground_excess, std::span<Rgb> from_ground) {
    parallel_blocks(rays.patches.size(), kRayBlock, [&](std::size_t from, std::size_t to) {
        for (std::size_t row = 4 * from; row < 4 * to; row += 2) { // both halves of a side together
            glm::vec3 sum(0.f);
            int count = 0;
            for (std::uint32_t i = rays.end_begin[row]; i < rays.end_begin[row + 2]; ++i)
                if (const std::size_t end = rays.ends[i]; end >= rays.sky_cells.size()) {
                    const std::size_t texel = end - rays.sky_cells.size();
                    sum += texel < ground_excess.size() ? ground_excess[texel] : glm::vec3(0.f);
                    ++count;
                }
            from_ground[2 * rays.patches[row / 4] + row / 2 % 2] = Rgb::from(count > 0 ? sum / float(count) : sum);
        }
    });
}

void sum_ray_open_directions(const RayLinks& rays, const Facets& facets, std::span<glm::vec3> sums) {
    for (std::size_t i = 0; i < rays.patches.size(); ++i) {
        glm::vec3 sum(0.f);
        for (std::uint32_t e = rays.end_begin[4 * i]; e < rays.end_begin[4 * i + 4]; ++e)
            if (rays.ends[e] < rays.sky_cells.size())
                sum += rays.sky_cells.directions[rays.ends[e]];
        sums[rays.patches[i]] = facets.patch_area[rays.patches[i]] / float(rays.rays_of(4 * i)) * sum;
    }
}

} // namespace kokage::bundles

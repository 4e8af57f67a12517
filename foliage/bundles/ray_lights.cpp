#include "foliage/bundles/ray_lights.h"

#include "common/services/parallel.h"
#include "foliage/light_visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage::bundles {

RayLights::RayLights(const RayQueries& queries, const PatchPoints& points, const RayLinks& links)
    : queries_(queries), points_(points), links_(links) {}

RayLights::Transfer RayLights::trace(const DistantLight& light, int rays_a_half, std::uint64_t seed,
                                     Progress& progress) const {
    Transfer transfer;
    transfer.shape = shape_key(light);
    transfer.irradiance = light.irradiance;
    transfer.rays_a_half = rays_a_half;
    transfer.received.assign(4 * links_.patches.size(), glm::vec3(0.f));
    parallel_blocks(links_.patches.size(), 64, [&](std::size_t from, std::size_t to) {
        progress.throw_if_stopped();
        for (std::size_t i = from; i < to; ++i) {
            const bool wide = links_.wide(i);
            const int rays = wide ? int(RayLinks::kRaysOfWide) * rays_a_half : rays_a_half;
            for (std::uint64_t h = 0; h < 2; ++h)
                for (int r = 0; r < rays; ++r) {
                    PathNumbers numbers(hash64(seed ^ hash64(2 * std::uint64_t(links_.patches[i]) + h)),
                                        std::uint32_t(r));
                    PatchPoint point;
                    if (!points_.sample(links_.patches[i], numbers, point))
                        continue;
                    const glm::vec2 pair = numbers.pair();
                    const LightSample sample = sample_light(light, pair.x, pair.y);
                    const float cosine = glm::dot(sample.direction, point.normal);
                    if (cosine == 0 || (wide && cosine < 0) ||
                        queries_.occluded(point.position, sample.direction, queries_.ray_offset(),
                                          std::numeric_limits<float>::infinity()))
                        continue;
                    const std::size_t row = 4 * i + (cosine < 0 ? 2 : 0) + h;
                    transfer.received[row] += std::abs(cosine) / float(rays) * sample.irradiance_over_pdf;
                }
        }
    });
    return transfer;
}

void RayLights::begin() {
    sum_.assign(4 * links_.patches.size(), glm::vec3(0.f));
    rays_ = 0;
    for (Transfer& transfer : kept_)
        transfer.used = false;
}

void RayLights::add(const DistantLight& light, const glm::vec3& scale, int rays, std::uint64_t seed,
                    Progress& progress) {
    const int half = std::max(2, (rays + 1) / 2);
    const std::uint64_t shape = shape_key(light);
    // Two lights in the same place take a transfer each, as their beams do.
    auto found = std::find_if(kept_.begin(), kept_.end(),
                              [&](const Transfer& kept) { return !kept.used && kept.shape == shape; });
    if (found == kept_.end())
        found = kept_.insert(kept_.end(), Transfer{});
    if (2 * half > 3 * found->rays_a_half) {
        *found = trace(light, half, seed, progress);
        rays_ += 2 * std::uint64_t(half) * links_.small_count;
    }
    found->used = true;
    glm::vec3 factor(0.f);
    for (int c = 0; c < 3; ++c)
        factor[c] = found->irradiance[c] > 0 ? scale[c] * (light.irradiance[c] / found->irradiance[c]) : 0.f;
    for (std::size_t row = 0; row < sum_.size(); ++row)
        sum_[row] += factor * found->received[row];
}

void RayLights::finish(std::vector<Rgb> (&halves)[2]) {
    for (std::size_t row = 0; row < sum_.size(); ++row)
        halves[row % 2][2 * links_.patches[row / 4] + row / 2 % 2] = Rgb::from(sum_[row]);
    std::erase_if(kept_, [](const Transfer& transfer) { return !transfer.used; });
}

std::size_t RayLights::bytes() const {
    std::size_t total = sum_.size() * sizeof(sum_[0]);
    for (const Transfer& transfer : kept_)
        total += transfer.received.size() * sizeof(glm::vec3);
    return total;
}

} // namespace kokage::bundles

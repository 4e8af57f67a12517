#include "reflection/gather_directions.h"
#include "common/directions/about_axis.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Without a ground, a remainder of less contrast has no bright parts.
constexpr double kEven = 1.2;
constexpr int kMostColumns = 512, kMostRows = 256;

/// Mean luminance of the remainder's pixels in each cell of at most 512 x 256, black where it is not seen.
Image seen_sky(const Image& remainder, bool above_ground) {
    Image cells(std::min(remainder.width, kMostColumns), std::min(remainder.height, kMostRows), 3);
    std::vector<double> sums(std::size_t(cells.width) * std::size_t(cells.height), 0.), counts = sums;
    for (int y = 0; y < remainder.height; ++y) {
        if (above_ground && 2 * y + 1 > remainder.height)
            break;
        const std::size_t row = std::size_t(std::int64_t(y) * cells.height / remainder.height);
        for (int x = 0; x < remainder.width; ++x) {
            const float* pixel = remainder.at(x, y);
            const std::size_t cell =
                row * std::size_t(cells.width) + std::size_t(std::int64_t(x) * cells.width / remainder.width);
            const float light = luminance({pixel[0], pixel[1], pixel[2]});
            sums[cell] += std::isfinite(light) ? double(std::max(light, 0.f)) : 0.;
            ++counts[cell];
        }
    }
    for (std::size_t k = 0; k < sums.size(); ++k)
        if (counts[k] > 0)
            sums[k] /= counts[k];
    // Radiance is interpolated between pixels: a bright one is seen round its own cell as well.
    for (int y = 0; y < cells.height; ++y)
        for (int x = 0; x < cells.width; ++x) {
            double mean = 0;
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    const int row = std::clamp(y + j, 0, cells.height - 1),
                              column = (x + i + cells.width) % cells.width;
                    mean += sums[std::size_t(row) * std::size_t(cells.width) + std::size_t(column)] *
                            (2 - std::abs(i)) * (2 - std::abs(j)) / 16;
                }
            std::fill_n(cells.at(x, y), 3, float(mean));
        }
    return cells;
}

} // namespace

GatherDirections::GatherDirections(const Environment& environment, bool above_ground)
    : seen_(seen_sky(environment.remainder, above_ground)) {
    auto sampler = std::make_unique<RemainderSampler>(seen_);
    if (above_ground || sampler->contrast() > kEven)
        sky_ = std::move(sampler);
}

GatherDirections::Lobes::Lobes(const glm::vec3& normal, const Optics& optics) : normal_(normal), optics_(optics) {
    const float reflected = luminance(optics.reflectance), transmitted = luminance(optics.transmittance);
    is_black_ = !(reflected + transmitted > 0);
    reflected_share_ = is_black_ ? 0 : reflected / (reflected + transmitted);
}

glm::vec3 GatherDirections::Lobes::direction(const glm::vec2& numbers) const {
    // One number chooses the side and goes on as the place within it, so that sequences stay even on both.
    const bool before = numbers.x < reflected_share_;
    const float place = before ? numbers.x / reflected_share_ : (numbers.x - reflected_share_) / (1 - reflected_share_);
    return about_axis(cosine_direction({std::min(place, 0x1.fffffep-1f), numbers.y}), before ? normal_ : -normal_);
}

float GatherDirections::Lobes::density(float cosine) const {
    return (cosine > 0 ? reflected_share_ : 1 - reflected_share_) * std::abs(cosine) / kPi;
}

GatherDirections::Drawn GatherDirections::drawn(const Lobes& lobes, const glm::vec3& direction) const {
    const float cosine = glm::dot(lobes.normal_, direction), of_lobes = lobes.density(cosine),
                of_sky = sky_ ? sky_->density(direction) : of_lobes;
    const glm::vec3 scattered =
        (cosine > 0 ? lobes.optics_.reflectance : lobes.optics_.transmittance) * (std::abs(cosine) / kPi);
    Drawn result{direction, glm::vec3(0.f), glm::vec3(0.f)};
    if (of_lobes > 0)
        result.surface_weight = scattered / of_lobes;
    if (const float all = of_lobes + kSkyRays * of_sky; all > 0)
        result.sky_weight = scattered / all;
    return result;
}

GatherDirections::Drawn GatherDirections::of_lobes(const Lobes& lobes, const glm::vec2& numbers) const {
    return lobes.is_black_ ? Drawn() : drawn(lobes, lobes.direction(numbers));
}

GatherDirections::Drawn GatherDirections::to_sky(const Lobes& lobes, const glm::vec2& numbers, float choice) const {
    return lobes.is_black_ ? Drawn()
                           : drawn(lobes, sky_ ? sky_->sample(numbers, choice).direction : lobes.direction(numbers));
}

} // namespace kokage

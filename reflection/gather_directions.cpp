#include "reflection/gather_directions.h"
#include "common/directions/about_axis.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Over a ground, a third of the rays for the sky tells as much as 1.4 times the rays of cosine lobes alone (an oak
/// under a clear sky; 0.25 and 0.5 are as good). Without one, a remainder of less contrast has no bright parts.
constexpr float kSkyShare = 0.35f;
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
    if (!(above_ground || sampler->contrast() > kEven))
        return;
    sky_share_ = kSkyShare;
    sky_ = std::move(sampler);
}

GatherDirections::Drawn GatherDirections::draw(const glm::vec3& normal, const Optics& optics, const glm::vec2& numbers,
                                               float choice) const {
    const float reflected = luminance(optics.reflectance), transmitted = luminance(optics.transmittance);
    Drawn drawn;
    if (!(reflected + transmitted > 0))
        return drawn;
    const float share = reflected / (reflected + transmitted);
    if (numbers.x < sky_share_) {
        drawn.direction = sky_->sample({numbers.x / sky_share_, numbers.y}, choice).direction;
    } else {
        const float place = (numbers.x - sky_share_) / (1 - sky_share_);
        const bool before = place < share;
        const float within = before ? place / share : (place - share) / (1 - share);
        drawn.direction = about_axis(cosine_direction({std::min(within, 0x1.fffffep-1f), numbers.y}), before ? normal : -normal);
    }
    const float cosine = glm::dot(normal, drawn.direction);
    const float lobe = (cosine > 0 ? share : 1 - share) * std::abs(cosine) / kPi;
    const float density = sky_share_ * (sky_ ? sky_->density(drawn.direction) : 0.f) + (1 - sky_share_) * lobe;
    if (density > 0)
        drawn.weight = (cosine > 0 ? optics.reflectance : optics.transmittance) * (std::abs(cosine) / (kPi * density));
    return drawn;
}

} // namespace kokage

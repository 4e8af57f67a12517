#include "common/trace/remainder_sampler.h"
#include "common/services/error.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace kokage {

RemainderSampler::RemainderSampler(const Image& remainder) : remainder_(remainder) {
    if (remainder.width < 1 || remainder.height < 1 || remainder.channels < 3)
        throw InputError("environment: the remainder is " + std::to_string(remainder.width) + " x " +
                         std::to_string(remainder.height) + " pixels of " + std::to_string(remainder.channels) +
                         " channels; it must be at least one pixel of RGB");
    const float* first = remainder.pixels.data();
    constant_ = true;
    for (std::size_t i = 0; i + 2 < remainder.pixels.size() && constant_; i += std::size_t(remainder.channels))
        constant_ = std::equal(first, first + 3, first + i);
    width_ = std::min(remainder.width, 512);
    height_ = std::min(remainder.height, 256);
    for (int y = 0; y <= height_; ++y)
        row_top_cosine_.push_back(float(std::cos(kPiDouble * y / height_)));
    fill_cells();
}

void RemainderSampler::fill_cells() {
    std::vector<double> energy(std::size_t(width_) * std::size_t(height_), 0.0), solid_angle = energy;
    double mean = 0, mean_square = 0;
    for (int y = 0; y < remainder_.height; ++y) {
        const double pixel_angle = pixel_solid_angle(y, remainder_.width, remainder_.height);
        const std::size_t row = std::size_t(std::int64_t(y) * height_ / remainder_.height) * std::size_t(width_);
        for (int x = 0; x < remainder_.width; ++x) {
            const float* pixel = remainder_.at(x, y);
            const double value = luminance({pixel[0], pixel[1], pixel[2]});
            energy[row + std::size_t(std::int64_t(x) * width_ / remainder_.width)] += value * pixel_angle;
            mean += value * pixel_angle / (4 * kPiDouble);
            mean_square += value * value * pixel_angle / (4 * kPiDouble);
        }
    }
    contrast_ = mean > 0 ? mean_square / (mean * mean) : 1;
    double total = 0;
    for (double value : energy)
        total += value;
    if (!(total > 0)) { // black: any density will do
        for (int y = 0; y < height_; ++y)
            for (int x = 0; x < width_; ++x)
                energy[std::size_t(y) * std::size_t(width_) + std::size_t(x)] = pixel_solid_angle(y, width_, height_);
        total = 4 * kPiDouble;
    }
    density_.resize(energy.size());
    for (std::size_t i = 0; i < energy.size(); ++i) {
        energy[i] /= total;
        density_[i] = float(energy[i] / pixel_solid_angle(int(i / std::size_t(width_)), width_, height_));
    }
    build_alias_table(energy);
}

/// Vose 1991: every cell holds a share of 1/n, made up of its own weight and of one other's.
void RemainderSampler::build_alias_table(const std::vector<double>& weights) {
    const std::size_t count = weights.size();
    cells_.assign(count, {1.f, 0});
    std::vector<double> scaled(count);
    std::vector<std::uint32_t> small, large;
    for (std::size_t i = 0; i < count; ++i) {
        scaled[i] = weights[i] * double(count);
        cells_[i].other = std::uint32_t(i);
        (scaled[i] < 1 ? small : large).push_back(std::uint32_t(i));
    }
    while (!small.empty() && !large.empty()) {
        const std::uint32_t less = small.back(), more = large.back();
        small.pop_back();
        cells_[less] = {float(scaled[less]), more};
        scaled[more] -= 1 - scaled[less];
        if (scaled[more] < 1) {
            large.pop_back();
            small.push_back(more);
        }
    }
}

RemainderSampler::Sample RemainderSampler::sample(glm::vec2 numbers, float choice) const {
    const float scaled = numbers.x * float(cells_.size());
    std::size_t index = std::min(std::size_t(scaled), cells_.size() - 1);
    const float fraction = scaled - float(index);
    // A number of its own: what is left of numbers.x has too few bits to tell a dark cell's share of 1e-4 from 0.
    if (choice >= cells_[index].keep)
        index = cells_[index].other;
    const std::size_t x = index % std::size_t(width_), y = index / std::size_t(width_);
    const float azimuth = ((float(x) + fraction) / float(width_) - 0.5f) * 2 * kPi;
    const float cosine = row_top_cosine_[y] + numbers.y * (row_top_cosine_[y + 1] - row_top_cosine_[y]);
    const float sine = std::sqrt(std::max(0.f, 1 - cosine * cosine));
    return {{sine * std::cos(azimuth), cosine, sine * std::sin(azimuth)}, density_[index]};
}

float RemainderSampler::density(const glm::vec3& direction) const {
    const glm::vec2 uv = lat_long_from_direction(direction);
    const int x = std::min(int(uv.x * float(width_)), width_ - 1),
              y = std::min(int(uv.y * float(height_)), height_ - 1);
    return density_[std::size_t(y) * std::size_t(width_) + std::size_t(x)];
}

glm::vec3 RemainderSampler::radiance(const glm::vec3& direction) const {
    if (constant_)
        return {remainder_.pixels[0], remainder_.pixels[1], remainder_.pixels[2]};
    return lat_long_radiance(remainder_, direction);
}

} // namespace kokage

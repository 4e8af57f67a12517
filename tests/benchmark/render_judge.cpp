#include "tests/benchmark/render_judge.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace kokage {
namespace {

constexpr std::size_t kKinds = 5;

double value(const Image& radiance, const PictureTruth& truth, std::size_t i, std::size_t channel) {
    return double(radiance.pixels[3 * std::size_t(truth.pixels[i]) + channel]);
}

/// Means by what pixels show.
class MeansOfKinds {
  public:
    void add(std::uint8_t kind, double value) {
        sums_[kind] += value;
        ++counts_[kind];
    }
    double of(std::size_t kind) const { return counts_[kind] > 0 ? sums_[kind] / counts_[kind] : 0; }
    double count(std::size_t kind) const { return counts_[kind]; }

  private:
    std::array<double, kKinds> sums_{}, counts_{};
};

} // namespace

void judge(const Image& radiance, const PictureTruth& truth, PictureRecord& record) {
    std::vector<double> errors;
    MeansOfKinds sizes, biases;
    double sum = 0, bias = 0;
    for (std::size_t i = 0; i < truth.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double difference =
                (value(radiance, truth, i, c) - double(truth.radiance[i][glm::length_t(c)])) / truth.mean;
            errors.push_back(std::abs(difference));
            sum += std::abs(difference);
            bias += difference;
            sizes.add(truth.kind[i], std::abs(difference));
            biases.add(truth.kind[i], difference);
        }
    record.reference_noise = truth.noise;
    if (errors.empty() || !(truth.mean > 0))
        return;
    const auto p95 = errors.begin() + std::ptrdiff_t(0.95 * double(errors.size() - 1));
    std::nth_element(errors.begin(), p95, errors.end());
    record.mean_error = sum / double(errors.size());
    record.p95_error = *p95;
    record.bias = bias / double(errors.size());
    for (std::size_t k = 0; k < kKinds; ++k)
        if (sizes.count(k) > 0) {
            const std::string& name = pixel_kinds()[k];
            record.mean_error_of[name] = sizes.of(k);
            record.bias_of[name] = biases.of(k);
            record.share_of[name] = sizes.count(k) / double(errors.size());
        }
}

void split_errors(const Image& a, const Image& b, const PictureTruth& truth, PictureRecord& record) {
    if (!(truth.mean > 0))
        return;
    MeansOfKinds shared, own;
    for (std::size_t i = 0; i < truth.pixels.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const double t = double(truth.radiance[i][glm::length_t(c)]),
                         noise = double(truth.half_difference[i][glm::length_t(c)]);
            const double of_a = value(a, truth, i, c), of_b = value(b, truth, i, c);
            shared.add(truth.kind[i], (of_a - t) * (of_b - t) - noise * noise);
            own.add(truth.kind[i], 0.5 * (of_a - of_b) * (of_a - of_b));
        }
    for (std::size_t k = 0; k < kKinds; ++k)
        if (shared.count(k) > 0) {
            record.systematic_error_of[pixel_kinds()[k]] = std::sqrt(std::max(0.0, shared.of(k))) / truth.mean;
            record.sampling_error_of[pixel_kinds()[k]] = std::sqrt(own.of(k)) / truth.mean;
        }
}

void split_bias(const Picture& picture, const Picture& traced, const PictureTruth& truth, PictureRecord& record) {
    if (!(truth.mean > 0) || !picture.layers || !traced.layers)
        return;
    for (const auto& [name, layer] :
         {std::pair("direct", &PictureLayers::direct), std::pair("indirect", &PictureLayers::indirect),
          std::pair("reflected", &PictureLayers::reflection)}) {
        const Image &drawn = (*picture.layers).*layer, &right = (*traced.layers).*layer;
        MeansOfKinds biases;
        for (std::size_t i = 0; i < truth.pixels.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c)
                biases.add(truth.kind[i], (value(drawn, truth, i, c) - value(right, truth, i, c)) / truth.mean);
        for (std::size_t k = 0; k < kKinds; ++k)
            if (biases.count(k) > 0)
                record.bias_by_light[pixel_kinds()[k]][name] = biases.of(k);
    }
}

} // namespace kokage

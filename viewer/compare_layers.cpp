#include "viewer/compare_layers.h"
#include "common/scene/image_layers.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kokage {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool is_finite_at(const Image& image, int x, int y) {
    const float* values = image.at(x, y);
    return std::all_of(values, values + image.channels, [](float value) { return std::isfinite(value); });
}

LayerComparison compare_numbers(const Image& image, const Image& reference) {
    LayerComparison result;
    result.difference = compare_images(image, reference).all;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const int finite_in = int(is_finite_at(image, x, y)) + int(is_finite_at(reference, x, y));
            result.pixels_finite_in_one += finite_in == 1 ? 1 : 0;
            result.pixels_finite_in_none += finite_in == 0 ? 1 : 0;
        }
    return result;
}

/// A hundred times as far as the middle one of all finite depths; infinite if none is.
double horizon_of(const Image& depth) {
    constexpr double kOfMedian = 100;
    std::vector<float> finite;
    std::copy_if(depth.pixels.begin(), depth.pixels.end(), std::back_inserter(finite),
                 [](float value) { return std::isfinite(value); });
    if (finite.empty())
        return kInfinity;
    const auto middle = finite.begin() + std::ptrdiff_t(finite.size() / 2);
    std::nth_element(finite.begin(), middle, finite.end());
    return kOfMedian * double(*middle);
}

LayerComparison compare_depths(const ImageLayer& layer, const ImageLayer& reference) {
    if (layer.image.pixels.size() != reference.image.pixels.size())
        return compare_numbers(layer.image, reference.image); // which says so
    const double horizon = horizon_of(reference.image);
    Image near = layer.image, near_reference = reference.image;
    std::size_t far = 0;
    for (std::size_t i = 0; i < near.pixels.size(); ++i) {
        float &a = near.pixels[i], &b = near_reference.pixels[i];
        if (!std::isfinite(a) || !std::isfinite(b) || (double(a) < horizon && double(b) < horizon))
            continue;
        a = b = float(kInfinity);
        ++far;
    }
    LayerComparison result = compare_numbers(near, near_reference);
    result.pixels_finite_in_none -= far;
    result.pixels_at_horizon = far;
    result.horizon_m = horizon;
    return result;
}

LayerComparison compare_names(const ImageLayer& layer, const ImageLayer& reference) {
    std::size_t differing = 0;
    for (std::size_t i = 0; i < layer.image.pixels.size(); ++i)
        differing += layer.image.pixels[i] != reference.image.pixels[i] ? 1 : 0;
    LayerComparison result;
    result.differing_share = double(differing) / double(layer.image.pixels.size());
    return result;
}

} // namespace

std::vector<LayerComparison> compare_layers(const std::filesystem::path& picture,
                                            const std::filesystem::path& reference) {
    if (lower_ending(picture) != ".exr" || lower_ending(reference) != ".exr")
        return {};
    const std::vector<ImageLayer> layers = load_layers(picture), references = load_layers(reference);
    std::vector<LayerComparison> comparisons;
    for (const ImageLayer& layer : layers) {
        const auto other = std::find_if(references.begin(), references.end(), [&](const ImageLayer& one) {
            return one.name == layer.name && one.channel_names == layer.channel_names;
        });
        if (layer.name.empty() || other == references.end() || layer.channel_names.size() > 4)
            continue;
        const bool names = layer.channel_names == std::vector<std::string>{"id"},
                   depths = layer.name == "depth" && layer.channel_names.size() == 1;
        comparisons.push_back(names    ? compare_names(layer, *other)
                              : depths ? compare_depths(layer, *other)
                                       : compare_numbers(layer.image, other->image));
        comparisons.back().name = layer.name;
    }
    return comparisons;
}

} // namespace kokage

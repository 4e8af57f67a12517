#include "viewer/compare_layers.h"
#include "common/scene/image_layers.h"
#include "common/services/named_file.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

bool is_finite_at(const Image& image, int x, int y) {
    const float* values = image.at(x, y);
    return std::all_of(values, values + image.channels, [](float value) { return std::isfinite(value); });
}

LayerComparison compare_numbers(const ImageLayer& layer, const ImageLayer& reference) {
    LayerComparison result;
    result.difference = compare_images(layer.image, reference.image).all;
    for (int y = 0; y < layer.image.height; ++y)
        for (int x = 0; x < layer.image.width; ++x)
            result.pixels_finite_in_one +=
                is_finite_at(layer.image, x, y) != is_finite_at(reference.image, x, y) ? 1 : 0;
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
        const bool names = layer.channel_names == std::vector<std::string>{"id"};
        comparisons.push_back(names ? compare_names(layer, *other) : compare_numbers(layer, *other));
        comparisons.back().name = layer.name;
    }
    return comparisons;
}

} // namespace kokage

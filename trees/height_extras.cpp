#include "trees/height_extras.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

constexpr std::uint64_t kMostHeights = 1u << 15; ///< along a side of an image

}

BarkHeights heights_of(std::span<const TreeMaterial> materials) {
    BarkHeights heights;
    for (const TreeMaterial& material : materials)
        if (const auto& image = material.height_texture;
            image && !image->empty() && std::find(heights.begin(), heights.end(), image) == heights.end())
            heights.push_back(image);
    return heights;
}

nlohmann::json write_heights(GltfWriter& writer, const BarkHeights& heights) {
    nlohmann::json entries = nlohmann::json::array();
    for (const auto& image : heights)
        entries.push_back({{"width", image->width},
                           {"height", image->height},
                           {"values", writer.add(std::span(image->pixels), GltfArrayUse::data, "height of bark")}});
    return entries;
}

void write_relief(const TreeMaterial& material, const BarkHeights& heights, nlohmann::json& entry) {
    const auto image = std::find(heights.begin(), heights.end(), material.height_texture);
    if (image != heights.end())
        entry["relief"] = {{"heights", std::size_t(image - heights.begin())},
                           {"depth", material.height_depth_m},
                           {"tile", material.height_tile_m}};
}

BarkHeights read_heights(ExtrasReader& reader, const nlohmann::json& extras) {
    BarkHeights heights;
    for (const nlohmann::json& entry : reader.list(extras, "heights")) {
        const std::uint64_t width = reader.count(entry, "width"), height = reader.count(entry, "height");
        reader.good = reader.good && width > 0 && height > 0 && width <= kMostHeights && height <= kMostHeights;
        if (!reader.good)
            return {};
        auto image = std::make_shared<Image>();
        image->width = int(width);
        image->height = int(height);
        image->channels = 1;
        image->pixels = reader.floats(entry, "values", width * height);
        for (const float value : image->pixels)
            reader.good = reader.good && std::isfinite(value);
        heights.push_back(std::move(image));
    }
    return heights;
}

void read_relief(ExtrasReader& reader, const nlohmann::json& entry, const BarkHeights& heights,
                 TreeMaterial& material) {
    const auto relief = entry.is_object() ? entry.find("relief") : entry.end();
    if (!entry.is_object() || relief == entry.end())
        return;
    const std::uint64_t image = reader.count(*relief, "heights");
    const float depth = reader.number(*relief, "depth"), tile = reader.number(*relief, "tile");
    reader.good = reader.good && image < heights.size() && depth >= 0 && tile >= 0;
    if (!reader.good)
        return;
    material.height_texture = heights[image];
    material.height_depth_m = depth;
    material.height_tile_m = tile;
}

} // namespace kokage

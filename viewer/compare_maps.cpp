#include "viewer/compare_maps.h"

#include "common/services/error.h"
#include "common/services/named_file.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/map_file.h"
#include "viewer/scene/output_check.h"

#include <algorithm>

namespace kokage {

bool is_reflection_map(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    return ending == ".ktx2" || ending == ".dds" || (ending == ".exr" && is_map_file(path));
}

FilteredMap load_reflection_map(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    if (ending == ".ktx2" || ending == ".dds") {
        CubeFile file = ending == ".dds" ? read_dds(path) : read_ktx2(path);
        try {
            return filtered_map(std::move(file.cube));
        } catch (const InputError& error) {
            throw InputError("'" + path.string() + "': " + error.what());
        }
    }
    return std::visit([](auto&& map) { return filtered_map(std::move(map)); }, read_map(path).map);
}

Image pictures_of_map(const FilteredMap& map, const MapComparison& comparison) {
    constexpr int width = 256;
    constexpr std::size_t most = 8;
    const std::size_t count = std::min(most, comparison.lobes.size());
    Image pictures(width, int(count) * width / 2, 3);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t lobe = count == 1 ? 0 : i * (comparison.lobes.size() - 1) / (count - 1);
        const Image picture = lat_long_of_map(map, comparison.lobes[lobe].parameter, width);
        std::copy(picture.pixels.begin(), picture.pixels.end(), pictures.at(0, int(i) * width / 2));
    }
    return pictures;
}

} // namespace kokage

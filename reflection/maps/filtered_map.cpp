#include "reflection/maps/filtered_map.h"

#include "common/services/error.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cstdio>
#include <memory>

namespace kokage {
namespace {

std::string range_text(const FilteredMap& map) {
    char text[100];
    std::snprintf(text, sizeof text, "%s %.4g to %.4g", std::string(lobe_kind_name(map.kind)).c_str(),
                  map.least_parameter, map.most_parameter);
    return text;
}

std::string size_text(double bytes) {
    char text[40];
    std::snprintf(text, sizeof text, "%.2f MB", bytes / 1e6);
    return text;
}

/// What levels are interpolated in.
double level_place(LobeKind kind, double parameter) {
    return kind == LobeKind::ggx ? parameter : lobe_width({kind, parameter});
}

} // namespace

FilteredMap filtered_map(ShellMap shells) {
    const auto map = std::make_shared<const ShellMap>(std::move(shells));
    const ShellSettings& settings = map->settings();
    FilteredMap result;
    result.kind = settings.kind;
    result.least_parameter = settings.least_parameter;
    result.most_parameter = settings.most_parameter;
    result.description = "shells, " + range_text(result) + ", " + std::to_string(map->shells().size()) + " shells, " +
                         size_text(double(map->bytes())) + " as " + std::string(texel_format_name(settings.format));
    result.lookup = [map](std::span<const glm::vec3> directions, double parameter, std::span<glm::vec3> filtered) {
        const std::vector<float> parameters(directions.size(), float(parameter));
        map->lookup(directions, parameters, filtered);
    };
    return result;
}

FilteredMap filtered_map(VoxelCube voxels) {
    const auto cube = std::make_shared<const VoxelCube>(std::move(voxels));
    FilteredMap result;
    result.kind = cube->layout().kind;
    const double roughest = cube->scale().exponent(cube->range().roughest);
    const double smoothest = cube->scale().exponent(cube->range().smoothest);
    const bool phong = result.kind == LobeKind::phong;
    result.least_parameter = phong ? roughest : roughness_from_exponent(smoothest);
    result.most_parameter = phong ? smoothest : roughness_from_exponent(roughest);
    result.description = "voxel cube, " + range_text(result) + ", " + std::to_string(cube->size()) + " voxels wide";
    result.lookup = [cube](std::span<const glm::vec3> directions, double parameter, std::span<glm::vec3> filtered) {
        const std::vector<float> smoothness(directions.size(), cube->smoothness(parameter));
        cube->lookup(directions, smoothness, filtered);
    };
    return result;
}

FilteredMap filtered_map(PrefilteredCube cube) {
    std::erase_if(cube.levels, [](const PrefilteredCube::Level& level) { return level.unfiltered; });
    if (cube.levels.empty())
        throw InputError("the cube map holds the image itself and no filtered level; bake it with a rougher level");
    const auto levels = std::make_shared<const PrefilteredCube>(std::move(cube));
    FilteredMap result;
    result.kind = levels->kind;
    for (const PrefilteredCube::Level& level : levels->levels)
        result.own_lobes.push_back(level.parameter);
    std::sort(result.own_lobes.begin(), result.own_lobes.end());
    result.least_parameter = result.own_lobes.front();
    result.most_parameter = result.own_lobes.back();
    result.description = "cube map, " + range_text(result) + ", " + std::to_string(levels->levels.size()) +
                         " filtered levels, the first " + std::to_string(levels->levels.front().size) + " texels wide";
    result.lookup = [levels](std::span<const glm::vec3> directions, double parameter, std::span<glm::vec3> filtered) {
        // Levels go from smooth to rough, so their places rise.
        const auto place = [&](std::size_t i) { return level_place(levels->kind, levels->levels[i].parameter); };
        const double wanted = level_place(levels->kind, parameter);
        std::size_t next = 0;
        while (next + 1 < levels->levels.size() && place(next) < wanted)
            ++next;
        const std::size_t first = next == 0 ? 0 : next - 1;
        const double share =
            next == first ? 0 : std::clamp((wanted - place(first)) / (place(next) - place(first)), 0.0, 1.0);
        parallel_blocks(directions.size(), 1024, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                filtered[i] = cube_lookup(*levels, glm::dvec3(directions[i]), double(first) + share);
        });
    };
    return result;
}

} // namespace kokage

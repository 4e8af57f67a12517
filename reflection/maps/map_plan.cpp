#include "reflection/maps/map_plan.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "reflection/maps/voxel_cube.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>

namespace kokage {

namespace {

constexpr int kPapersSize = 128, kUsualFace = 256, kLeastFace = 16;
/// Cube maps: texels a lobe's width, as fine as shells are.
constexpr double kTexelsAWidth = ShellSettings{}.texels_a_width;
constexpr double kLeastShellRoughness = 0.03; ///< a little within what shell_map.h takes of both lobes
/// KTX 2 and DDS files of more than that are not read back.
constexpr std::uint64_t kMostFileBytes = std::uint64_t(1) << 34;

/// Λ, or roughness: from rough to smooth.
struct ParameterRange {
    double roughest, smoothest;
};

void check_range(const MapSettings& settings) {
    if (settings.smoothness) {
        const auto& [roughest, smoothest] = *settings.smoothness;
        if (!(roughest >= 0 && roughest <= smoothest && smoothest <= 1))
            throw InputError("a range of smoothness goes from rough to smooth, within 0 and 1: 0.3,0.6");
    }
    if (settings.roughness) {
        const auto& [smoothest, roughest] = *settings.roughness;
        if (!(smoothest >= 0 && smoothest <= roughest && roughest <= 1))
            throw InputError("a range of roughness goes from smooth to rough, within 0 and 1: 0.2,0.5");
        if (smoothest == 0 && settings.container != MapContainer::cube_map)
            throw InputError("roughness 0 is a mirror, which only cube maps (.ktx2, .dds) hold; begin at 0.03 or more");
        if (settings.container == MapContainer::shells && smoothest < kLeastShellRoughness)
            throw InputError(
                "shells hold nothing smoother than roughness 0.03; begin there, or take a cube map (.ktx2, "
                ".dds)");
        if (settings.smoothness)
            throw InputError("a range is given in smoothness or in roughness, not in both");
    }
}

/// Of a range that was given.
ParameterRange parameters_of(const MapSettings& settings) {
    const bool phong = settings.lobe == LobeKind::phong;
    if (settings.roughness) {
        const auto& [smoothest, roughest] = *settings.roughness;
        if (!phong)
            return {roughest, smoothest};
        return {exponent_from_roughness(roughest), exponent_from_roughness(smoothest)};
    }
    const RoughnessScale scale = scale_of(settings);
    const double low = scale.exponent(settings.smoothness->roughest);
    const double high = scale.exponent(settings.smoothness->smoothest);
    if (phong)
        return {low, high};
    return {roughness_from_exponent(low), roughness_from_exponent(high)};
}

double roughness_of(LobeKind kind, double parameter) {
    return kind == LobeKind::ggx ? parameter : roughness_from_exponent(parameter);
}

double parameter_of(LobeKind kind, double roughness) {
    return kind == LobeKind::ggx ? roughness : exponent_from_roughness(roughness);
}

/// Texels along a face's edge that a cube map of nothing smoother than a roughness needs.
int needed_face(double smoothest_roughness) {
    // Judged by Phong's lobe, whose width is that of the light: GGX's is of normals, half of it.
    const Lobe as_phong{LobeKind::phong, exponent_from_roughness(smoothest_roughness)};
    const double needed = kPiDouble / 2 / lobe_width(as_phong) * kTexelsAWidth; // infinite for the image itself
    return needed >= kUsualFace ? kUsualFace : int(std::bit_ceil(unsigned(std::max(std::ceil(needed), 1.0))));
}

int usual_levels(const MapSettings& settings, int size) {
    const int usual = usual_level_count(size);
    return settings.most_levels > 0 ? std::min(usual, settings.most_levels) : usual;
}

CubeSettings cube_of_range(const MapSettings& settings) {
    CubeSettings cube;
    cube.kind = settings.lobe;
    const ParameterRange range = parameters_of(settings);
    const double from = roughness_of(cube.kind, range.smoothest), to = roughness_of(cube.kind, range.roughest);
    const bool one_lobe = from == to;
    if (one_lobe && settings.levels > 1)
        throw InputError("cube map: " + std::to_string(settings.levels) +
                         " levels of one roughness would all be alike; ask for one level, or for a wider range");
    const int asked = settings.levels > 0 && settings.levels <= 15 ? settings.levels : 1;
    cube.size = settings.size > 0 ? settings.size : std::max({needed_face(from), kLeastFace, 1 << (asked - 1)});
    const int levels = settings.levels > 0 ? settings.levels : one_lobe ? 1 : usual_levels(settings, cube.size);
    for (int level = 0; level < levels; ++level)
        cube.parameters.push_back(
            level == 0 ? range.smoothest : parameter_of(cube.kind, std::lerp(from, to, double(level) / (levels - 1))));
    return cube;
}

// Peak memory a texel, measured (peak_memory_bytes of the report, spectral, which takes the most): texels as floats,
// their layout, the baker's places and copies of it, sums, and the file as floats and as halves.
constexpr std::uint64_t kBytesAFilteredTexel = 100, kBytesAStoredTexel = 32;

void plan_shells(const MapSettings& settings, MapPlan& plan) {
    const ShellSettings shells = shell_settings(settings);
    const auto all = [](int resolution, int border) {
        return 6 * std::uint64_t(resolution + 2 * border) * std::uint64_t(resolution + 2 * border);
    };
    std::uint64_t stored = 0;
    for (const ShellMap::Shell& shell : ShellMap::plan(shells)) {
        plan.texels += all(shell.resolution, ShellMap::baked_border(shells.filter));
        stored += all(shell.resolution, ShellMap::border(shells.filter));
        plan.levels.push_back({shell.resolution, shell.lobe, false});
        plan.size = std::max(plan.size, shell.resolution);
    }
    plan.bytes = stored * texel_bytes(settings.format);
    plan.peak_bytes = plan.texels * kBytesAFilteredTexel + stored * kBytesAStoredTexel;
}

void plan_voxels(const MapSettings& settings, MapPlan& plan) {
    const VoxelCube::Extent extent = VoxelCube::extent(scale_of(settings).cube_size(), smoothness_of(settings));
    const std::uint64_t edge = std::uint64_t(extent.size), stored = edge * edge * edge;
    plan.texels = extent.texels;
    plan.size = extent.size;
    plan.bytes = stored * texel_bytes(settings.format);
    plan.peak_bytes = plan.texels * kBytesAFilteredTexel + stored * kBytesAStoredTexel;
}

void plan_cube_map(const MapSettings& settings, MapPlan& plan) {
    const CubeSettings cube = cube_settings(settings);
    check_cube(cube);
    // Files keep an alpha beside half and float colours.
    const std::uint64_t each =
        settings.format == TexelFormat::shared_exponent ? 4 : texel_bytes(settings.format) / 3 * 4;
    std::uint64_t stored = 0;
    for (std::size_t i = 0; i < cube.parameters.size(); ++i) {
        const int size = cube.size >> i;
        const std::uint64_t texels = 6 * std::uint64_t(size) * std::uint64_t(size);
        const bool unfiltered = is_unfiltered(cube.kind, cube.parameters[i]);
        plan.levels.push_back({size, {cube.kind, cube.parameters[i]}, unfiltered});
        plan.texels += unfiltered ? 0 : texels;
        stored += texels;
    }
    plan.size = cube.size;
    plan.bytes = stored * each;
    if (plan.bytes > kMostFileBytes)
        throw InputError("cube map: its file would have " + count_text(plan.bytes / 1000000) +
                         " MB, and more than 16 GB are not read back; ask for smaller faces");
    plan.peak_bytes = plan.texels * kBytesAFilteredTexel + stored * kBytesAStoredTexel;
}

} // namespace

std::string_view map_container_name(MapContainer container) {
    switch (container) {
    case MapContainer::shells:
        return "shells";
    case MapContainer::voxel_cube:
        return "cube";
    case MapContainer::cube_map:
        return "cube map";
    case MapContainer::harmonics:
        return "harmonics";
    }
    return "";
}

RoughnessScale scale_of(const MapSettings& settings) {
    const bool own = settings.container == MapContainer::voxel_cube && settings.size > 0;
    const int size = own ? settings.size : kPapersSize;
    return settings.scale == ScaleRule::paper ? RoughnessScale::as_printed(size) : RoughnessScale::solved(size);
}

ScaleRule scale_rule_from_name(std::string_view name) {
    if (name == "solved")
        return ScaleRule::solved;
    if (name == "paper")
        return ScaleRule::paper;
    throw InputError("there is no scale of roughness called '" + std::string(name) + "'; there are: solved, paper");
}

SmoothnessRange smoothness_of(const MapSettings& settings) {
    check_range(settings);
    if (!settings.roughness)
        return settings.smoothness.value_or(SmoothnessRange{});
    const RoughnessScale scale = scale_of(settings);
    const auto smoothness = [&](double roughness) { return scale.smoothness(exponent_from_roughness(roughness)); };
    const SmoothnessRange range{smoothness(settings.roughness->roughest), smoothness(settings.roughness->smoothest)};
    if (range.smoothest > 1) {
        char least[32];
        std::snprintf(least, sizeof least, "%.3g", std::ceil(1e3 * roughness_from_exponent(scale.exponent(1))) / 1e3);
        throw InputError("a voxel cube holds nothing smoother than roughness " + std::string(least) +
                         "; begin there, or take shells");
    }
    return range;
}

ShellSettings shell_settings(const MapSettings& settings) {
    check_range(settings);
    ShellSettings shells;
    shells.kind = settings.lobe;
    shells.filter = settings.filter;
    shells.format = settings.format;
    shells.texels_a_width = settings.texels_a_width;
    const ParameterRange all =
        settings.lobe == LobeKind::phong ? ParameterRange{1, 5000} : ParameterRange{1, roughness_from_exponent(5000)};
    const ParameterRange range = settings.has_range() ? parameters_of(settings) : all;
    shells.least_parameter = std::min(range.roughest, range.smoothest);
    shells.most_parameter = std::max(range.roughest, range.smoothest);
    return shells;
}

CubeSettings cube_settings(const MapSettings& settings) {
    check_range(settings);
    if (settings.has_range())
        return cube_of_range(settings);
    CubeSettings cube;
    cube.kind = settings.lobe;
    cube.size = settings.size > 0 ? settings.size : kUsualFace;
    cube.parameters = even_roughness(settings.levels > 0 ? settings.levels : usual_levels(settings, cube.size));
    for (double& parameter : cube.parameters)
        parameter = parameter_of(settings.lobe, parameter);
    return cube;
}

MapPlan plan_map(const MapSettings& settings) {
    if (settings.scale == ScaleRule::paper && settings.lobe != LobeKind::phong)
        throw InputError("the paper's scale of roughness is of Phong's lobe; GGX has glTF's roughness");
    MapPlan plan;
    switch (settings.container) {
    case MapContainer::voxel_cube:
        plan_voxels(settings, plan);
        break;
    case MapContainer::cube_map:
        plan_cube_map(settings, plan);
        break;
    case MapContainer::harmonics:
        plan.bytes = sh_count(settings.harmonics.bands) * sizeof(glm::vec3);
        plan.peak_bytes = plan.bytes;
        break;
    case MapContainer::shells:
        plan_shells(settings, plan);
        break;
    }
    return plan;
}

std::optional<WorkReport::Skip> saved_by_range(const MapSettings& settings) {
    if (!settings.has_range())
        return std::nullopt;
    MapSettings whole = settings;
    whole.smoothness.reset();
    whole.roughness.reset();
    const MapPlan all = plan_map(whole), part = plan_map(settings);
    if (part.texels >= all.texels && part.bytes >= all.bytes)
        return std::nullopt;
    const auto figure = [](const MapPlan& plan) {
        return count_text(plan.texels) + " texels, " + count_text(plan.bytes / 1000) + " kB";
    };
    return WorkReport::Skip{"what is rougher or smoother",
                            std::string("only a range of ") + (settings.roughness ? "roughness" : "smoothness") +
                                " was asked for",
                            figure(all) + " became " + figure(part)};
}

} // namespace kokage

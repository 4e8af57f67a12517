#include "reflection/maps/baked_map.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "reflection/maps/baked_harmonics.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/map_file.h"
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/voxel_cube.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace kokage {

namespace {

constexpr int kPapersSize = 128, kUsualFace = 256, kLeastFace = 16;
/// Cube maps: texels a lobe's width, as fine as shells are.
constexpr double kTexelsAWidth = ShellSettings{}.texels_a_width;

/// Λ, or roughness: from rough to smooth.
struct ParameterRange {
    double roughest, smoothest;
};

ParameterRange parameters_of(const MapSettings& settings, const SmoothnessRange& range) {
    const RoughnessScale scale = scale_of(settings);
    const double low = scale.exponent(range.roughest), high = scale.exponent(range.smoothest);
    if (settings.lobe == LobeKind::phong)
        return {low, high};
    return {roughness_from_exponent(low), roughness_from_exponent(high)};
}

void warn_of_clamped(std::size_t texels, TexelFormat format, WorkReport& report) {
    if (texels > 0)
        report.warnings.push_back(counted(texels, "texel is", "texels are") + " brighter than the format " +
                                  std::string(texel_format_name(format)) +
                                  " can hold, and cut off there; --format float holds them");
}

void warn_of_clamped(std::span<const glm::vec3> texels, TexelFormat format, WorkReport& report) {
    constexpr float kMostHalf = 65504, kMostShared = 65408; // texel_format.h
    if (format == TexelFormat::float_rgb)
        return;
    const float most = format == TexelFormat::half_rgb ? kMostHalf : kMostShared;
    const auto too_bright = [&](const glm::vec3& t) { return std::max({t.x, t.y, t.z}) > most; };
    warn_of_clamped(std::size_t(std::count_if(texels.begin(), texels.end(), too_bright)), format, report);
}

class Shells final : public BakedMap {
  public:
    explicit Shells(const MapSettings& settings) : map_(shell_settings(settings)), compression_(settings.compression) {}
    const TexelLayout& layout() const override { return map_.layout(); }
    std::uint64_t bytes() const override { return map_.bytes(); }
    void bake(const Environment& surroundings, Baker* baker, WorkReport& report, Progress& progress) override {
        filtered_.resize(layout().size());
        baker->bake(surroundings, filtered_, report, progress);
        map_.set_texels(filtered_);
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                 WorkReport& report) const override {
        warn_of_clamped(filtered_, map_.settings().format, report);
        return packed_map(path, map_, made_from, compression_);
    }

  private:
    static ShellSettings shell_settings(const MapSettings& settings) {
        ShellSettings shells;
        shells.kind = settings.lobe;
        shells.filter = settings.filter;
        shells.format = settings.format;
        shells.texels_a_width = settings.texels_a_width;
        const ParameterRange all = settings.lobe == LobeKind::phong ? ParameterRange{1, 5000}
                                                                    : ParameterRange{1, roughness_from_exponent(5000)};
        const ParameterRange range = settings.smoothness ? parameters_of(settings, *settings.smoothness) : all;
        shells.least_parameter = std::min(range.roughest, range.smoothest);
        shells.most_parameter = std::max(range.roughest, range.smoothest);
        return shells;
    }
    ShellMap map_;
    ExrCompression compression_;
    std::vector<glm::vec3> filtered_;
};

class Voxels final : public BakedMap {
  public:
    explicit Voxels(const MapSettings& settings)
        : cube_(settings.lobe, scale_of(settings)), format_(settings.format), compression_(settings.compression),
          used_(used_texels(settings)) {
        layout_.kind = cube_.layout().kind;
        for (std::size_t texel : used_) {
            layout_.directions.push_back(cube_.layout().directions[texel]);
            layout_.parameters.push_back(cube_.layout().parameters[texel]);
        }
    }
    const TexelLayout& layout() const override { return layout_; }
    std::uint64_t bytes() const override { return cube_.voxels().size() * texel_bytes(format_); }
    void bake(const Environment& surroundings, Baker* baker, WorkReport& report, Progress& progress) override {
        filtered_.resize(layout_.size());
        baker->bake(surroundings, filtered_, report, progress);
        std::vector<glm::vec3> all(cube_.layout().size(), glm::vec3(0.f));
        for (std::size_t i = 0; i < used_.size(); ++i)
            all[used_[i]] = filtered_[i];
        cube_.set_texels(all);
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                 WorkReport& report) const override {
        warn_of_clamped(filtered_, format_, report);
        return packed_map(path, cube_, format_, made_from, compression_);
    }

  private:
    /// Those that a trilinear lookup within the range reads: up to a voxel's diagonal beyond it.
    std::vector<std::size_t> used_texels(const MapSettings& settings) const {
        const SmoothnessRange range = settings.smoothness.value_or(SmoothnessRange{0, 2});
        const double n = cube_.size(), s = n - 2, diagonal = std::sqrt(3.0) * 2 / s;
        const auto looked_up_at = [&](double smoothness) {
            return std::hypot(smoothness, 2 * VoxelCube::centre_radius / s);
        };
        const double least = looked_up_at(range.roughest) - diagonal, most = looked_up_at(range.smoothest) + diagonal;
        std::vector<std::size_t> used;
        for (std::size_t texel = 0; texel < cube_.layout().size(); ++texel) {
            const std::size_t voxel = cube_.voxel_of_texel()[texel], width = std::size_t(cube_.size());
            const glm::dvec3 place(double(voxel % width), double(voxel / width % width), double(voxel / width / width));
            const double smoothness = glm::length((place - (n - 1) / 2) * 2.0 / s);
            if (smoothness >= least && smoothness <= most)
                used.push_back(texel);
        }
        return used;
    }
    VoxelCube cube_;
    TexelFormat format_;
    ExrCompression compression_;
    std::vector<std::size_t> used_;
    TexelLayout layout_;
    std::vector<glm::vec3> filtered_;
};

class CubeMap final : public BakedMap {
  public:
    explicit CubeMap(const MapSettings& settings)
        : cube_(empty_cube(cube_settings(settings))), layout_(filtered_layout(cube_)), format_(settings.format) {}
    const TexelLayout& layout() const override { return layout_; }
    std::uint64_t bytes() const override {
        // Files keep an alpha beside half and float colours.
        const std::size_t texel = format_ == TexelFormat::shared_exponent ? 4 : texel_bytes(format_) / 3 * 4;
        std::uint64_t texels = 0;
        for (const PrefilteredCube::Level& level : cube_.levels)
            texels += level.texels.size();
        return texels * texel;
    }
    void bake(const Environment& surroundings, Baker* baker, WorkReport& report, Progress& progress) override {
        bake_cube(cube_, surroundings, baker, report, progress);
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string&,
                                 WorkReport& report) const override {
        const auto made_by = lower_ending(path) == ".dds" ? dds_bytes : ktx2_bytes;
        CubeFileBytes made = made_by(cube_, format_, path.string());
        warn_of_clamped(made.summary.clamped_texels, format_, report);
        return [path, bytes = std::move(made.bytes)] { write_file(path, std::span(bytes)); };
    }

  private:
    static CubeSettings cube_settings(const MapSettings& settings) {
        CubeSettings cube;
        cube.kind = settings.lobe;
        cube.size = settings.size > 0 ? settings.size : kUsualFace;
        const int levels = settings.levels > 0 ? settings.levels : usual_level_count(cube.size);
        if (!settings.smoothness) {
            cube.parameters = even_roughness(levels);
            if (settings.lobe == LobeKind::phong)
                for (double& parameter : cube.parameters)
                    parameter = exponent_from_roughness(parameter);
            return cube;
        }
        const ParameterRange range = parameters_of(settings, *settings.smoothness);
        const Lobe smoothest{settings.lobe, range.smoothest};
        // Judged by Phong's lobe, whose width is that of the light: GGX's is of normals, half of it.
        const Lobe as_phong{LobeKind::phong, scale_of(settings).exponent(settings.smoothness->smoothest)};
        const int needed =
            int(std::bit_ceil(unsigned(std::ceil(kPiDouble / 2 / lobe_width(as_phong) * kTexelsAWidth))));
        if (std::has_single_bit(unsigned(cube.size)))
            cube.size = std::min(cube.size, std::max(needed, kLeastFace));
        const int fitting = std::min(levels, usual_level_count(cube.size));
        const double from = roughness_of(smoothest), to = roughness_of({settings.lobe, range.roughest});
        for (int level = 0; level < fitting; ++level) {
            const double roughness = fitting == 1 ? from : std::lerp(from, to, double(level) / (fitting - 1));
            cube.parameters.push_back(settings.lobe == LobeKind::ggx ? roughness : exponent_from_roughness(roughness));
        }
        return cube;
    }
    static double roughness_of(const Lobe& lobe) {
        return lobe.kind == LobeKind::ggx ? lobe.parameter : roughness_from_exponent(lobe.parameter);
    }
    PrefilteredCube cube_;
    TexelLayout layout_;
    TexelFormat format_;
};

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

std::unique_ptr<BakedMap> make_map(const MapSettings& settings) {
    if (settings.smoothness) {
        const auto& [roughest, smoothest] = *settings.smoothness;
        if (!(roughest >= 0 && roughest <= smoothest && smoothest <= 1))
            throw InputError("a range of smoothness goes from rough to smooth, within 0 and 1: 0.3,0.6");
    }
    if (settings.scale == ScaleRule::paper && settings.lobe != LobeKind::phong)
        throw InputError("the paper's scale of roughness is of Phong's lobe; GGX has glTF's roughness");
    switch (settings.container) {
    case MapContainer::voxel_cube:
        return std::make_unique<Voxels>(settings);
    case MapContainer::cube_map:
        return std::make_unique<CubeMap>(settings);
    case MapContainer::harmonics:
        return make_baked_harmonics(settings.harmonics);
    case MapContainer::shells:
        break;
    }
    return std::make_unique<Shells>(settings);
}

std::optional<WorkReport::Skip> saved_by_range(const MapSettings& settings, const BakedMap& map) {
    if (!settings.smoothness)
        return std::nullopt;
    MapSettings whole = settings;
    whole.smoothness.reset();
    const std::unique_ptr<BakedMap> all = make_map(whole);
    const auto figure = [](const BakedMap& m) {
        return count_text(m.layout().size()) + " texels, " + count_text(m.bytes() / 1000) + " kB";
    };
    return WorkReport::Skip{"what is rougher or smoother", "only a range of smoothness was asked for",
                            figure(*all) + " became " + figure(map)};
}

} // namespace kokage

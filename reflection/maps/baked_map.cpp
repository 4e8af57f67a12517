#include "reflection/maps/baked_map.h"
#include "common/services/count_text.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "reflection/maps/baked_harmonics.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/map_file.h"
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/voxel_cube.h"

#include <algorithm>

namespace kokage {

namespace {

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

/// Half floats and shared exponents end at steps of 2^-24: what is below 2^-14 loses digits there.
void warn_of_dim(std::span<const glm::vec3> texels, TexelFormat format, WorkReport& report) {
    constexpr float kLeastExact = 1.f / 16384;
    if (format == TexelFormat::float_rgb)
        return;
    float brightest = 0;
    for (const glm::vec3& t : texels)
        brightest = std::max({brightest, t.x, t.y, t.z});
    if (brightest > 0 && brightest < kLeastExact)
        report.warnings.push_back("all texels are so dim that the format " + std::string(texel_format_name(format)) +
                                  " keeps few digits of them, or none; --format float holds them");
}

class Shells final : public BakedMap {
  public:
    explicit Shells(const MapSettings& settings)
        : plan_(plan_map(settings)), map_(shell_settings(settings)), compression_(settings.compression) {}
    const TexelLayout& layout() const override { return map_.layout(); }
    const MapPlan& plan() const override { return plan_; }
    void bake(const Environment& surroundings, Baker* baker, WorkReport& report, Progress& progress) override {
        filtered_.resize(layout().size());
        baker->bake(surroundings, filtered_, report, progress);
        map_.set_texels(filtered_);
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                 WorkReport& report) const override {
        warn_of_clamped(filtered_, map_.settings().format, report);
        warn_of_dim(filtered_, map_.settings().format, report);
        return packed_map(path, map_, made_from, compression_);
    }

  private:
    MapPlan plan_;
    ShellMap map_;
    ExrCompression compression_;
    std::vector<glm::vec3> filtered_;
};

class Voxels final : public BakedMap {
  public:
    explicit Voxels(const MapSettings& settings)
        : plan_(plan_map(settings)), cube_(settings.lobe, scale_of(settings), smoothness_of(settings)),
          format_(settings.format), compression_(settings.compression) {}
    const TexelLayout& layout() const override { return cube_.layout(); }
    const MapPlan& plan() const override { return plan_; }
    void bake(const Environment& surroundings, Baker* baker, WorkReport& report, Progress& progress) override {
        filtered_.resize(layout().size());
        baker->bake(surroundings, filtered_, report, progress);
        cube_.set_texels(filtered_);
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                 WorkReport& report) const override {
        warn_of_clamped(filtered_, format_, report);
        warn_of_dim(filtered_, format_, report);
        return packed_map(path, cube_, format_, made_from, compression_);
    }

  private:
    MapPlan plan_;
    VoxelCube cube_;
    TexelFormat format_;
    ExrCompression compression_;
    std::vector<glm::vec3> filtered_;
};

class CubeMap final : public BakedMap {
  public:
    explicit CubeMap(const MapSettings& settings)
        : plan_(plan_map(settings)), cube_(empty_cube(cube_settings(settings))), layout_(filtered_layout(cube_)),
          format_(settings.format), only_image_(plan_.texels == 0 && settings.levels == 0) {}
    const TexelLayout& layout() const override { return layout_; }
    const MapPlan& plan() const override { return plan_; }
    void bake(const Environment& surroundings, Baker* baker, WorkReport& report, Progress& progress) override {
        if (only_image_)
            report.warnings.push_back("faces of " + std::to_string(plan_.size) +
                                      " texels can't be halved: the map holds the image itself and nothing filtered; "
                                      "take a power of two");
        bake_cube(cube_, surroundings, baker, report, progress);
    }
    std::function<void()> packed(const std::filesystem::path& path, const std::string&,
                                 WorkReport& report) const override {
        const auto made_by = lower_ending(path) == ".dds" ? dds_bytes : ktx2_bytes;
        CubeFileBytes made = made_by(cube_, format_, path.string());
        warn_of_clamped(made.summary.clamped_texels, format_, report);
        // Filtering makes nothing brighter: the first level has the brightest texel.
        warn_of_dim(cube_.levels.front().texels, format_, report);
        return [path, bytes = std::move(made.bytes)] { write_file(path, std::span(bytes)); };
    }

  private:
    MapPlan plan_;
    PrefilteredCube cube_;
    TexelLayout layout_;
    TexelFormat format_;
    bool only_image_; ///< though nobody asked for that
};

} // namespace

std::unique_ptr<BakedMap> make_map(const MapSettings& settings) {
    switch (settings.container) {
    case MapContainer::voxel_cube:
        return std::make_unique<Voxels>(settings);
    case MapContainer::cube_map:
        return std::make_unique<CubeMap>(settings);
    case MapContainer::harmonics:
        return make_baked_harmonics(settings);
    case MapContainer::shells:
        break;
    }
    return std::make_unique<Shells>(settings);
}

} // namespace kokage

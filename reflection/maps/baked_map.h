#pragma once
// What is baked into and written to a file: shells, the voxel cube, a prefiltered cube map or spherical harmonics,
// alike to who bakes them.
#include "reflection/maps/exr_notes.h"
#include "reflection/maps/harmonics.h"
#include "reflection/maps/make_baker.h"
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/shell_map.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace kokage {

enum class MapContainer {
    shells,     ///< shell_map.h, as .exr (default)
    voxel_cube, ///< voxel_cube.h, as .exr
    cube_map,   ///< prefiltered_cube.h, as .ktx2 or .dds
    harmonics,  ///< harmonics.h, as .json; nothing is filtered, and no baker needed
};
std::string_view map_container_name(MapContainer container); ///< "shells", "cube", "cube map", "harmonics"

/// A part of the roughness scale, in smoothness λ of [R] (roughness_scale.h), 0 <= roughest <= smoothest <= 1.
struct SmoothnessRange {
    double roughest = 0, smoothest = 1;
};

/// Which u of [R] eq 12 (roughness_scale.h) tells smoothness from exponents.
enum class ScaleRule {
    solved, ///< that of Λ = 5000 at λ = 1, whatever the cube's size
    paper,  ///< 6.2 as printed, which is Λ = 4733 at λ = 1 of 128 voxels
};
/// "solved", "paper"; throws InputError that lists them.
ScaleRule scale_rule_from_name(std::string_view name);

struct MapSettings {
    MapContainer container = MapContainer::shells;
    LobeKind lobe = LobeKind::phong;
    /// Voxel cube: the paper's s, voxels along an edge. Cube map: texels along a face's edge at the smoothest level.
    /// Shells find their own size from their lobes, and need none.
    int size = 0;
    int levels = 0;                                         ///< cube map: mip levels; 0 = as many as are usual
    double texels_a_width = ShellSettings{}.texels_a_width; ///< shells
    TexelFilter filter = TexelFilter::bilinear;             ///< shells
    TexelFormat format = TexelFormat::half_rgb;
    ExrCompression compression = ExrCompression::zip; ///< of .exr files
    /// Only this part is baked, at the resolution that it needs. Empty = all: shells from Λ = 1 (roughness 1) to Λ =
    /// 5000, the cube's every voxel, cube maps from the image itself to roughness 1.
    std::optional<SmoothnessRange> smoothness{};
    /// Where the cube's voxels stand, and how `smoothness` is read. Phong alone has another than `solved`.
    ScaleRule scale = ScaleRule::solved;
    HarmonicsSettings harmonics{};
};

/// The scale that `smoothness` is read by: of the cube's own size, else of 128, the paper's. Files of cubes keep it,
/// and their lookups go by it.
RoughnessScale scale_of(const MapSettings& settings);

class BakedMap {
  public:
    virtual ~BakedMap() = default;
    /// What a baker has to be made for; may be empty (a cube map of the image alone, harmonics).
    virtual const TexelLayout& layout() const = 0;
    virtual std::uint64_t bytes() const = 0; ///< of all texels in their format
    /// Fills the texels. `baker` was made for layout(); null if that is empty.
    virtual void bake(const Environment& surroundings, Baker* baker, WorkReport& report,
                      Progress& progress = silent_progress()) = 0;
    /// Copies what the file needs: the function that is returned writes it, whole or not at all, while the map may be
    /// baked anew. The ending of `path` says as what. `made_from`: a line about the surroundings, kept where the file
    /// has a place for it. Adds a warning to the report for texels that the format can't hold. Both throw InputError.
    virtual std::function<void()> packed(const std::filesystem::path& path, const std::string& made_from,
                                         WorkReport& report) const = 0;
    void write(const std::filesystem::path& path, const std::string& made_from, WorkReport& report) const {
        packed(path, made_from, report)();
    }
};

/// Throws InputError for settings that make no map.
std::unique_ptr<BakedMap> make_map(const MapSettings& settings);

/// What the range saves against all of it: a line for the report's skips, from two layouts; empty without a range.
std::optional<WorkReport::Skip> saved_by_range(const MapSettings& settings, const BakedMap& map);

} // namespace kokage

#pragma once
// What map is asked for, and what it will have and take: known before any memory is taken.
#include "common/services/work_report.h"
#include "reflection/maps/exr_notes.h"
#include "reflection/maps/harmonics.h"
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/shell_map.h"

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace kokage {

enum class MapContainer {
    shells,     ///< shell_map.h, as .exr (default)
    voxel_cube, ///< voxel_cube.h, as .exr
    cube_map,   ///< prefiltered_cube.h, as .ktx2 or .dds
    harmonics,  ///< harmonics.h, as .json; nothing is filtered, and no baker needed
};
std::string_view map_container_name(MapContainer container); ///< "shells", "cube", "cube map", "harmonics"

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
    /// Shells find their own size from their lobes, and need none. 0 = as usual: cubes of 128; cube maps of 256, or,
    /// with a range, as small as its lobes allow.
    int size = 0;
    int levels = 0;      ///< cube map: mip levels; 0 = as many as are usual, or one if the range is one lobe
    int most_levels = 0; ///< cube map: no more of the usual levels than that (a file's limit); 0 = no limit
    double texels_a_width = ShellSettings{}.texels_a_width; ///< shells
    TexelFilter filter = TexelFilter::bilinear;             ///< shells
    TexelFormat format = TexelFormat::half_rgb;
    ExrCompression compression = ExrCompression::zip; ///< of .exr files
    /// Only this part is baked, at the resolution that it needs; lookups outside of it give its nearest end. At most
    /// one of the two. Empty = all: shells from Λ = 1 (roughness 1) to Λ = 5000, the cube's every voxel, cube maps from
    /// the image itself to roughness 1.
    std::optional<SmoothnessRange> smoothness{};
    std::optional<RoughnessRange> roughness{};
    /// Where the cube's voxels stand, and how `smoothness` is read. Phong alone has another than `solved`.
    ScaleRule scale = ScaleRule::solved;
    HarmonicsSettings harmonics{};
    bool has_range() const { return smoothness || roughness; }
};

/// The scale that `smoothness` is read by: of the cube's own size, else of 128, the paper's. Files of cubes keep it,
/// and their lookups go by it.
RoughnessScale scale_of(const MapSettings& settings);
/// The range in λ of that scale, whichever way it was given; the whole if it was not.
SmoothnessRange smoothness_of(const MapSettings& settings);

/// What make_map() makes of the settings, each for its container. Throw InputError for settings that make no map.
ShellSettings shell_settings(const MapSettings& settings);
CubeSettings cube_settings(const MapSettings& settings);

/// A shell or a mip level.
struct MapLevel {
    int size = 0; ///< texels along a face's edge
    Lobe lobe;
    bool unfiltered = false; ///< the image itself
};

struct MapPlan {
    std::uint64_t texels = 0;     ///< that a baker filters: layout().size() of the map
    std::uint64_t bytes = 0;      ///< of all texels in their format: BakedMap::bytes()
    int size = 0;                 ///< along an edge: voxels as stored, texels of the largest level or shell
    std::vector<MapLevel> levels; ///< of shells from rough to smooth, of a cube map from smooth to rough; else empty
    /// Peak of the memory that grows with the map while it is baked and written: texels, what bakers keep of each, the
    /// file. Within a quarter (tested); the program, tables of harmonics (some 200 MB at most) and the image come to
    /// that.
    std::uint64_t peak_bytes = 0;
};
/// Throws InputError for settings that make no map.
MapPlan plan_map(const MapSettings& settings);

/// What the range saves against all of it, from two plans: a line for the report's skips; empty without a range, or
/// where it saves nothing.
std::optional<WorkReport::Skip> saved_by_range(const MapSettings& settings);

} // namespace kokage

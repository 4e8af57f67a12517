#pragma once
// Ambient occlusion of relief, stored per texel as openness: the share of a uniform sky's light that reaches a point of
// the surface, 1 - A_p with A_p by eq 3 of [D]. 1 on a flat surface, near 0 at the bottom of a deep hole.
#include "common/services/progress.h"
#include "reflection/relief/depth_maps.h"

#include <array>
#include <vector>

namespace kokage {

/// A point within a cell does not see beyond the cell's own slope, the next cell's point beyond another: openness jumps
/// where cells meet, as slopes do. So every cell has four values of its own, those that its points near its corners
/// have; between them it is bilinear. A texel's centre, where four cells meet, sees more than any of them and has a
/// fifth value: what an image of occlusion shows. A byte each, 1/255; together 5 bytes a texel.
struct ReliefOpenness {
    int width = 0, height = 0;
    HeightWrap wrap = HeightWrap::repeat;
    std::vector<std::uint8_t> texels;                 ///< at their centres, row by row from the top row
    std::vector<std::array<std::uint8_t, 4>> corners; ///< of texel (x, y) within the cells to its lower right, lower
                                                      ///< left, upper right, upper left

    /// Within 1/1000 of a texel from a texel's centre, the texel's; else the cell's.
    float lookup(const glm::vec2& coordinate) const;
    std::size_t bytes() const { return texels.size() + 4 * corners.size(); }
};

/// Which N stands in eq 3's N · ω.
enum class OpennessNormal {
    plane,   ///< the polygon's: openness multiplies light that was gathered about its normal
    surface, ///< the relief's own: each cell's, and at a texel the mean of the four around it
};

struct OpennessSettings {
    ReliefScale scale; ///< depth_m 0: open everywhere
    OpennessNormal normal = OpennessNormal::surface;
    int azimuths = 48; ///< about so many horizons a texel; 4 to 256
};

/// Checked files; refused by name when cut off, altered, of another version, or made for another height field or other
/// settings.
void save_openness(const ReliefOpenness& openness, const std::filesystem::path& path, const HeightField& field,
                   const OpennessSettings& settings);
ReliefOpenness load_openness(const std::filesystem::path& path, const HeightField& field,
                             const OpennessSettings& settings);

/// From horizons (horizon_sweep.h). All threads; the same bits on any number of them. Throws InputError for settings
/// that make no sense, Stopped.
ReliefOpenness horizon_openness(const HeightField& field, const OpennessSettings& settings,
                                Progress& progress = silent_progress());

/// Eq 3 of [D] from depth maps (first_hits) of this field: over their directions, blocked where the ray from the sky
/// to the texel hits at a depth less than the texel's by more than `same_hit`.
ReliefOpenness depth_map_openness(const HeightField& field, const DepthMaps& maps, OpennessNormal normal,
                                  float same_hit = 1.f / 32, Progress& progress = silent_progress());

} // namespace kokage

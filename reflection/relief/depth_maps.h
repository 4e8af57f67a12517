#pragma once
// Depth maps of a height field: for a grid of directions on the hemisphere over it, how deep the ray through each point
// O of the reference plane gets along that direction (Suzuki, An Accelerated Relief Mapping Using Depth Maps, 2006:
// [D]).
//
//          O            Directions are evenly spaced in angle on a surface of `scale`: map = ring * azimuths + sector,
//     -----+--------    zenith angle = ring * 90° / zeniths (ring 0 looks straight down; 84.4° is the last of 16),
//           \   __      azimuth    = sector * 360° / azimuths, from +u towards +v.
//         __ \ /  \     [D] has 32 in θ and 16 in φ and says no more: we take 32 azimuths and 16 zenith angles, steps
//         of
//        /  \_v    \    11.25° and 5.6°; the other way round the azimuth would be up to 11.25° off.
//
// Texel (x, y) of a map stands for the points O with u in [x, x+1)/size, v in [y, y+1)/size. A byte a texel, rounded
// towards the plane: 1/255 of the relief's depth is an eighth of a texel of 256² at a depth of 0.12, less than one step
// of the search that follows. So 512 maps of 32² are 512 KB, where [D] states 192 KB without saying how.
#include "common/services/large_vector.h"
#include "common/services/progress.h"
#include "reflection/relief/relief_tracer.h"

#include <cstdint>
#include <filesystem>
#include <span>

namespace kokage {

enum class DepthMapKind : std::uint64_t {
    first_hits,   ///< [D]: the depth of the first hit of single rays along the sampling direction itself
    lower_bounds, ///< no ray through the texel whose direction is in the sampling direction's cell hits before it
};

struct DepthMapSettings {
    int azimuths = 32, zeniths = 16; ///< each >= 1
    int size = 64;                   ///< texels along each edge, 1 to 1024
    /// First hits are traced on maps this large, a multiple of `size` by a power of two, and shrunk by eq 2 of [D].
    /// 0: the least such size from 256 on. Lower bounds need none.
    int traced_size = 0;
    ReliefScale scale; ///< depth_m > 0

    int maps() const { return azimuths * zeniths; }
    /// Throws InputError for what makes no maps, or more than 1 GiB of them.
    void check() const;
};

class DepthMaps {
  public:
    /// Stored depths, one map after another, each row by row.
    DepthMaps(DepthMapKind kind, const DepthMapSettings& settings, LargeVector<std::uint8_t> depths);

    DepthMapKind kind() const { return kind_; }
    const DepthMapSettings& settings() const { return settings_; }
    std::size_t bytes() const { return texels_per_map() * std::size_t(settings_.maps()); }
    std::size_t texels_per_map() const { return std::size_t(settings_.size) * std::size_t(settings_.size); }
    const std::uint8_t* depths() const { return depths_.data(); }
    float depth(int map, int x, int y) const {
        return float(depths_[std::size_t(map) * texels_per_map() + std::size_t(y) * std::size_t(settings_.size) +
                             std::size_t(x)]) /
               255.f;
    }

    /// Checked files; refused by name when cut off, altered, of another version, or made for another height field or
    /// other settings.
    void save(const std::filesystem::path& path, const HeightField& field) const;
    static DepthMaps load(const std::filesystem::path& path, const HeightField& field, DepthMapKind kind,
                          const DepthMapSettings& settings);

  private:
    DepthMapKind kind_;
    DepthMapSettings settings_;
    LargeVector<std::uint8_t> depths_;
};

/// A sampling direction: how far it goes along u and v per unit of depth, in units of scale.depth_m (so that its length
/// is the tangent of the zenith angle).
glm::dvec2 sampling_slope(const DepthMapSettings& settings, int map);
/// The same in relief space: tiles per unit of depth.
glm::dvec2 relief_slope(const ReliefScale& scale, const glm::dvec2& slope);

/// First hits by `source` (any tracer of the height field; exact is fastest), on all threads; the same bits on any
/// number of them. Throws InputError (DepthMapSettings::check), Stopped.
DepthMaps trace_depth_maps(const DepthMapSettings& settings, const ReliefTracer& source,
                           Progress& progress = silent_progress());

/// Least depths at which rays of a direction's cell (half a step to either side in azimuth, from its zenith angle to
/// the next) through a texel can hit. Beyond kLastBoundedZenith no ray is promised
/// anything.
DepthMaps bound_depth_maps(const HeightField& field, const DepthMapSettings& settings,
                           Progress& progress = silent_progress());
inline constexpr double kLastBoundedZenith = 88; ///< degrees: lower_bounds holds for rays up to here

} // namespace kokage

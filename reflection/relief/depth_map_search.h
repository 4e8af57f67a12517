#pragma once
// [D]'s search in vector code. Private to relief: depth_map_tracer calls it.
#include "reflection/relief/depth_maps.h"
#include "reflection/relief/lane_rays.h"
#include "reflection/relief/padded_depths.h"

namespace kokage {

/// Depth maps as a search reads them.
struct DepthMapTable {
    explicit DepthMapTable(const DepthMaps& maps); ///< which are kept by reference

    const std::uint8_t* depths;
    int azimuths, zeniths, size;
    std::vector<float> slopes; ///< sampling_slope of each map: two numbers each
    glm::vec2 tile_in_depths;  ///< a tile's extent in units of depth_m
};

struct DepthMapSearch;

void search_depth_maps(const PaddedDepths& field, const DepthMapTable& maps, const DepthMapSearch& search,
                       std::span<const ReliefRay> rays, const LaneResults& results);

/// For maps of lower bounds: depths where rays may begin, for what is hit first is not above them; -1 where nothing is
/// promised, and nothing was read.
void read_bounds(const DepthMapTable& maps, HeightWrap wrap, std::span<const ReliefRay> rays, float* bounds);

} // namespace kokage

#pragma once
// What tracers of rays in lanes (ray_lanes-inl.h) share outside of vector code. Private to relief.
#include "reflection/relief/relief_ray.h"

#include <functional>
#include <span>
#include <vector>

namespace kokage {

/// Where results of a block of rays go.
struct LaneResults {
    ReliefHit* hits = nullptr; ///< null: only whether there is a hit is asked for, and goes to
    std::uint8_t* hidden = nullptr;
    std::uint32_t* reads = nullptr;          ///< may be null
    std::vector<std::size_t>* odd = nullptr; ///< takes rays whose numbers are beyond single precision; not answered
};

using TraceBlock = std::function<void(std::span<const ReliefRay>, const LaneResults&)>;

/// Blocks of rays through `trace`, and the odd ones among them cell by cell.
void trace_in_lanes(const HeightField& field, std::span<const ReliefRay> rays, std::span<ReliefHit> hits,
                    const TraceBlock& trace);
void occlude_in_lanes(const HeightField& field, std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                      std::span<std::uint32_t> reads, const TraceBlock& trace);

} // namespace kokage

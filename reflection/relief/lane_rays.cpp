#include "reflection/relief/lane_rays.h"
#include "reflection/relief/cell_by_cell.h"

#include <algorithm>

namespace kokage {
namespace {

constexpr std::size_t kLaneBlock = 1 << 16; ///< rays, whose numbers fit in 32 bits and whose results fit in a cache

/// The tracer of one ray, with its own rounding to floats.
ReliefHit hit_cell_by_cell(const HeightField& field, const ReliefRay& ray) {
    ReliefHit hit;
    make_cell_by_cell_tracer(field)->trace({&ray, 1}, {&hit, 1});
    return hit;
}

} // namespace

void trace_in_lanes(const HeightField& field, std::span<const ReliefRay> rays, std::span<ReliefHit> hits,
                    const TraceBlock& trace) {
    std::vector<std::size_t> odd;
    for (std::size_t first = 0; first < rays.size(); first += kLaneBlock) {
        const auto block = rays.subspan(first, std::min(kLaneBlock, rays.size() - first));
        odd.clear();
        trace(block, {hits.data() + first, nullptr, nullptr, &odd});
        for (const std::size_t ray : odd)
            hits[first + ray] = hit_cell_by_cell(field, block[ray]);
    }
}

void occlude_in_lanes(const HeightField& field, std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                      std::span<std::uint32_t> reads, const TraceBlock& trace) {
    std::vector<std::size_t> odd;
    for (std::size_t first = 0; first < rays.size(); first += kLaneBlock) {
        const auto block = rays.subspan(first, std::min(kLaneBlock, rays.size() - first));
        odd.clear();
        trace(block, {nullptr, hidden.data() + first, reads.empty() ? nullptr : reads.data() + first, &odd});
        for (const std::size_t ray : odd) {
            const TrueReliefHit hit = true_relief_hit(field, block[ray]);
            hidden[first + ray] = hit.found();
            if (!reads.empty())
                reads[first + ray] = hit.reads;
        }
    }
}

} // namespace kokage

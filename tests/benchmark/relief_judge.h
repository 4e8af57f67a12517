#pragma once
// What a tracer's hits are worth: against the truth, in reads and in time.
#include "common/services/progress.h"
#include "reflection/relief/cell_by_cell.h"
#include "tests/benchmark/relief_record.h"

#include <span>
#include <vector>

namespace kokage {

/// By cell_by_cell, on all threads.
std::vector<TrueReliefHit> true_hits(const HeightField& field, std::span<const ReliefRay> rays, Progress& progress);

/// Where a hit and the truth are further apart than half a texel (along the ray, depth counting `depth_in_tiles` a
/// unit), either is a tie: the nearer of both touches, or the further one lies behind what touches, the surface within
/// this depth.
inline constexpr double kTieDepth = 1e-6;

/// Into wrong, ties, reads_mean, reads_p99, rays.
void judge(const HeightField& field, std::span<const ReliefRay> rays, std::span<const ReliefHit> hits,
           std::span<const TrueReliefHit> truth, double depth_in_tiles, ReliefRecord& record);

/// Traces on one thread; work of less than half a second is repeated up to five times, and the median's time told as
/// ns_per_ray.
std::vector<ReliefHit> timed_trace(const ReliefTracer& tracer, std::span<const ReliefRay> rays, ReliefRecord& record);

} // namespace kokage

#pragma once
// Streams of rays against bound planes and cells in vector code. Private to relief: exact_tracer calls it.
#include "reflection/relief/bound_planes.h"
#include "reflection/relief/relief_ray.h"

#include <span>
#include <vector>

namespace kokage {

/// A ray whose answer single precision can't be sure of: it hits nothing before t, counted from where it enters the
/// relief.
struct DoubtfulRay {
    std::size_t ray = 0;
    float t = 0;
};

/// First hits. `hits` of the rays named in `doubtful` hold just the reads so far.
void trace_stream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, ReliefHit* hits,
                  std::vector<DoubtfulRay>& doubtful);
/// Whether there is a hit; `reads` may be null. `hidden` of doubtful rays is not set, `reads` is.
void occlude_stream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, std::uint8_t* hidden,
                    std::uint32_t* reads, std::vector<DoubtfulRay>& doubtful);

} // namespace kokage

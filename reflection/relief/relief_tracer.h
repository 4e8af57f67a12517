#pragma once
// First hits of rays on relief: one interface, several methods.
#include "reflection/relief/relief_ray.h"

#include <memory>
#include <span>
#include <string_view>

namespace kokage {

enum class ReliefMethod {
    exact,        ///< a hierarchy of bounds over cells, exact roots, streams of rays in vector code (default)
    linear,       ///< Policarpo 2005: equal steps, then bisection; thin features may be passed
    depth_maps,   ///< [D] to the letter: the nearest sampling direction's depth, then a search to and fro
    conservative, ///< depth maps that never pass the hit, finished exactly
    cone,         ///< cone step mapping (Dummer 2006): never passes the hit, slows down at grazing angles
    cell_by_cell, ///< every cell under the ray, double precision: the truth
};
std::string_view relief_method_name(ReliefMethod method);
/// "exact", "linear", "depth-maps", "conservative", "cone", "cell-by-cell"; throws InputError that lists them.
ReliefMethod relief_method_from_name(std::string_view name);

/// Made for one height field. Thread-safe; uses the calling thread alone (callers cut rays into blocks with
/// parallel_blocks). Each ray's result is the same whatever rays are beside it.
class ReliefTracer {
  public:
    virtual ~ReliefTracer() = default;
    /// First hits; `hits` has as many elements as `rays`.
    virtual void trace(std::span<const ReliefRay> rays, std::span<ReliefHit> hits) const = 0;
    /// Shadows: 1 where trace() would find a hit, 0 where the ray gets away; `reads` (empty: not wanted) as
    /// ReliefHit's. For rays from the surface towards a light see relief_shadow_ray.
    virtual void occluded(std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                          std::span<std::uint32_t> reads = {}) const = 0;
    virtual std::size_t bytes() const = 0; ///< of what a ray may read: depths and precomputed data
};

} // namespace kokage

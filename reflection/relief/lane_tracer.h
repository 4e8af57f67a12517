#pragma once
// A tracer all of whose rays go through one search in vector code. Private to relief.
#include "reflection/relief/lane_rays.h"
#include "reflection/relief/relief_tracer.h"

namespace kokage {

/// `Base`: ReliefTracer, or what extends it. `field` is kept by reference.
template <class Base>
class LaneTracer : public Base {
  public:
    explicit LaneTracer(const HeightField& field) : field_(field) {}

    void trace(std::span<const ReliefRay> rays, std::span<ReliefHit> hits) const final {
        trace_in_lanes(field_, rays, hits, [&](auto block, const LaneResults& results) { search(block, results); });
    }
    void occluded(std::span<const ReliefRay> rays, std::span<std::uint8_t> hidden,
                  std::span<std::uint32_t> reads) const final {
        occlude_in_lanes(field_, rays, hidden, reads,
                         [&](auto block, const LaneResults& results) { search(block, results); });
    }

  protected:
    virtual void search(std::span<const ReliefRay> rays, const LaneResults& results) const = 0;

    const HeightField& field_;
};

} // namespace kokage

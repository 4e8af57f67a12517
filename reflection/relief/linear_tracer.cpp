#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/relief/linear_tracer.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "common/services/error.h"
#include "reflection/relief/lane_tracer.h"
#include "reflection/relief/linear_tracer.h"
#include "reflection/relief/ray_lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace kokage::relief_lanes::HWY_NAMESPACE {
namespace {

/// Both phases at once: lanes that step and lanes that bisect read their cells together.
template <bool kRepeat, bool kAny>
class LinearSteps {
  public:
    LinearSteps(const PaddedDepths& field, const LinearSearch& search)
        : field_(field), steps_(float(search.steps)), bisections_(float(search.bisections)) {
        low_ = high_ = step_ = index_ = hn::Zero(Tag());
        bisected_ = hn::Zero(Tag());
        found_ = {low_, low_, low_, low_};
    }

    HWY_INLINE void Start(const Rays& rays, Mask starts) {
        const Vec zero = hn::Zero(Tag()), one = Constant(1);
        step_ = hn::IfThenElse(starts, hn::Mul(rays.t_last, Constant(1 / steps_)), step_);
        // From the reference plane the first step needs no read: nothing is above it.
        Vec first = hn::IfThenElseZero(hn::Le(rays.depth, zero), one);
        first = hn::IfThenElse(hn::Le(rays.t_last, zero), Constant(steps_), first); // all steps are the same one
        index_ = hn::IfThenElse(starts, first, index_);
        bisected_ = hn::IfThenElse(starts, Constant(-1), bisected_);
        low_ = hn::IfThenElse(starts, zero, low_);
    }

    HWY_INLINE Found Step(Rays& rays, Mask& hit, Mask& missed) {
        const Tag d;
        const Vec zero = hn::Zero(d), one = Constant(1);
        const Mask bisecting = hn::Ge(bisected_, zero);
        const Vec t = hn::IfThenElse(bisecting, hn::Mul(Constant(0.5f), hn::Add(low_, high_)), hn::Mul(index_, step_));
        const Place place = PlaceOf<kRepeat>(field_, hn::MulAdd(t, rays.dx, rays.x), hn::MulAdd(t, rays.dy, rays.y));
        const Cells cells = CellsAt(field_, place);
        rays.reads = hn::Add(rays.reads, Whole(1));
        const Vec depth = cells.depth(place.a, place.b);
        const Mask below = hn::Ge(hn::MulAdd(t, rays.ddepth, rays.depth), depth);
        missed = hn::AndNot(hn::Or(bisecting, below), hn::Ge(index_, Constant(steps_)));
        if constexpr (kAny) {
            hit = below;
            index_ = hn::Add(index_, one);
            return found_;
        }
        found_.t = high_ = hn::IfThenElse(below, t, high_);
        found_.depth = hn::IfThenElse(below, depth, found_.depth);
        found_.slope_u = hn::IfThenElse(below, cells.slope_a(place.b), found_.slope_u);
        found_.slope_v = hn::IfThenElse(below, cells.slope_b(place.a), found_.slope_v);
        low_ = hn::IfThenElse(below, low_, t);
        bisected_ = hn::IfThenElse(hn::Or(bisecting, below), hn::Add(bisected_, one), bisected_);
        const Mask inside_at_start = hn::And(below, hn::Eq(t, zero));
        hit = hn::Or(inside_at_start, hn::Ge(bisected_, Constant(bisections_)));
        index_ = hn::IfThenElse(bisecting, index_, hn::Add(index_, one));
        return found_;
    }

  private:
    const PaddedDepths& field_;
    float steps_, bisections_;
    Vec step_, index_; ///< of the next one
    Vec low_, high_;   ///< t of the last point above the surface, and of one below
    Vec bisected_;     ///< -1: still stepping
    Found found_;
};

template <bool kRepeat>
void Linear(const PaddedDepths& field, const LinearSearch& search, std::span<const ReliefRay> rays,
            const LaneResults& results) {
    if (results.hits)
        RayStream<kRepeat, LinearSteps<kRepeat, false>>(field, rays, results, {field, search}).run();
    else
        RayStream<kRepeat, LinearSteps<kRepeat, true>>(field, rays, results, {field, search}).run();
}

} // namespace

void TraceLinear(const PaddedDepths& field, const LinearSearch& search, std::span<const ReliefRay> rays,
                 const LaneResults& results) {
    if (field.wrap == HeightWrap::repeat)
        Linear<true>(field, search, rays, results);
    else
        Linear<false>(field, search, rays, results);
}

} // namespace kokage::relief_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {
namespace relief_lanes {

HWY_EXPORT(TraceLinear);

} // namespace relief_lanes

namespace {

class LinearTracer final : public LaneTracer<ReliefTracer> {
  public:
    LinearTracer(const HeightField& field, const LinearSearch& search)
        : LaneTracer(field), padded_(field), options_(search) {}

    std::size_t bytes() const override { return padded_.bytes(); }

  private:
    void search(std::span<const ReliefRay> rays, const LaneResults& results) const override {
        using namespace relief_lanes;
        HWY_DYNAMIC_DISPATCH(TraceLinear)(padded_, options_, rays, results);
    }

    PaddedDepths padded_;
    LinearSearch options_;
};

} // namespace

std::unique_ptr<ReliefTracer> make_linear_tracer(const HeightField& field, const LinearSearch& search) {
    if (search.steps < 1 || search.steps > 65536 || search.bisections < 0 || search.bisections > 32)
        throw InputError("linear search of " + std::to_string(search.steps) + " steps and " +
                         std::to_string(search.bisections) +
                         " bisections can't be done; give 1 to 65536 steps and 0 to 32 bisections");
    return std::make_unique<LinearTracer>(field, search);
}

} // namespace kokage
#endif

#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/relief/exact_stream.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "reflection/relief/exact_entry-inl.h"
#include "reflection/relief/exact_results-inl.h"
#include "reflection/relief/exact_stream.h"

#include <algorithm>

// Each lane of a vector follows a ray of its own through the hierarchy; a lane whose ray is done takes the next one of
// the stream. A lane stands at time t in a cell (i, j), which is tracked in whole numbers, and looks at one node over
// that cell: the ray's height over the node's plane is linear in t, so either the ray stays above it all through the
// node and goes on to the next, or it goes on to where it dives through the plane, and looks closer. How close, the
// node's thickness tells: the hit lies between the plane and another one that much deeper.
//
// Single precision does not lose hits: rays count as low as the surface where they are within `error` of it, a bound
// on all that rounding may do to a ray's height over the surface (see ErrorAt). Where only that makes a hit, there
// is a doubt; a doubt that a certain hit nearby does not settle is left to double precision.
HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

using namespace exact_lanes::HWY_NAMESPACE;

constexpr float kSettled = 0.125f;          ///< texels between a doubt and a certain hit that settles it
constexpr float kSettledDepth = 1.f / 1024; ///< depth between both: steep rays beside walls get deep within a texel

template <bool kRepeat, bool kAny>
class Stream {
  public:
    Stream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, ReliefHit* hits, std::uint8_t* hidden,
           std::uint32_t* reads, std::vector<DoubtfulRay>& doubtful)
        : bounds_(bounds), entry_(bounds, rays), results_(bounds, hits, hidden, reads, doubtful) {
        int first[16] = {}, columns[16] = {};
        for (std::size_t l = 0; l < bounds.levels.size(); ++l) {
            first[l] = int(bounds.levels[l].first);
            columns[l] = bounds.levels[l].columns;
        }
        std::copy(first, first + 16, first_);
        std::copy(columns, columns + 16, node_columns_);
        first_of_.set(first_);
        columns_of_.set(node_columns_);
    }

    void run() {
        Lanes groups[kGroups];
        for (Lanes& lanes : groups) {
            for (Vec* field : FieldsOf(lanes))
                *field = hn::Zero(Tag());
            lanes.i = lanes.j = lanes.t = lanes.doubt = hn::Zero(Tag());
            lanes.reads = lanes.ray = hn::Zero(IntTag());
            lanes.level = Whole(-1);
        }
        for (bool busy = true; busy;) {
            busy = false;
            for (Lanes& lanes : groups)
                busy |= Step(lanes);
        }
    }

  private:
    static constexpr std::size_t kRefill = std::max<std::size_t>(1, kLanes / 4), kGroups = 2,
                                 kCellBatch = std::max<std::size_t>(1, kLanes / 2);

    /// False where there is nothing left to do.
    HWY_INLINE bool Step(Lanes& lanes) {
        const auto is_idle = [&] { // not by MaskFromVec: before AVX-512 a mask is right only if a lane's bits are alike
            return hn::RebindMask(Tag(), hn::Lt(lanes.level, hn::Zero(IntTag())));
        };
        Mask idle = is_idle();
        std::size_t idle_count = hn::CountTrue(Tag(), idle);
        while (idle_count >= kRefill && entry_.has_rays()) {
            entry_.Refill(lanes, idle, results_);
            idle = is_idle();
            idle_count = hn::CountTrue(Tag(), idle);
        }
        if (idle_count == kLanes)
            return false;
        const Mask in_cells = hn::RebindMask(Tag(), hn::Eq(lanes.level, hn::Zero(IntTag())));
        const std::size_t cell_count = hn::CountTrue(Tag(), in_cells);
        if (cell_count >= kCellBatch || cell_count + idle_count == kLanes)
            CellStep(lanes, in_cells);
        else
            NodeStep(lanes);
        return true;
    }

    // ---- places

    /// i modulo count (repeat).
    HWY_INLINE static Vec Wrapped(Vec i, float count) {
        const Vec tile = hn::Floor(hn::Mul(hn::Add(i, Constant(0.5f)), Constant(1 / count)));
        return hn::NegMulAdd(tile, Constant(count), i);
    }

    /// The part of a ray in a node or cell: borders as lanes' i and j, and times.
    struct Span {
        Vec i0, i1, j0, j1;
        Vec t_out;
        Mask leaves_x; ///< across a border of x
    };

    HWY_INLINE static Span SpanIn(const Lanes& g, Vec i0, Vec i1, Vec j0, Vec j1) {
        Span span{i0, i1, j0, j1, g.t, Mask()};
        const Vec zero = hn::Zero(Tag());
        // A ray that does not move along an axis has its border at kFarAway times a distance > 0.
        const Vec border_x = hn::IfThenElse(hn::Ge(g.dx, zero), i1, i0),
                  border_y = hn::IfThenElse(hn::Ge(g.dy, zero), j1, j0);
        const Vec t_x = hn::Mul(hn::Sub(border_x, g.x), g.dt_x), t_y = hn::Mul(hn::Sub(border_y, g.y), g.dt_y);
        span.leaves_x = hn::Le(t_x, t_y);
        span.t_out = hn::Max(g.t, hn::Min(hn::Min(t_x, t_y), g.t_last));
        return span;
    }

    /// Moves lanes of `moving` to time t, and where they `leave` a span, across its border.
    HWY_INLINE void Move(Lanes& g, const Span& span, Mask moving, Mask leave, Vec t, Int level) const {
        const Vec one = Constant(1), zero = hn::Zero(Tag());
        const auto along = [&](Vec& cell, Vec first, Vec last, Vec origin, Vec direction, Mask crosses) {
            const Mask onwards = hn::Ge(direction, zero);
            const Vec end = hn::Sub(last, one);
            const Vec least = hn::IfThenElse(onwards, cell, first), most = hn::IfThenElse(onwards, end, cell);
            Vec next = hn::Max(least, hn::Min(hn::Floor(hn::MulAdd(t, direction, origin)), most));
            next = hn::IfThenElse(crosses, hn::IfThenElse(onwards, last, hn::Sub(first, one)), next);
            cell = hn::IfThenElse(moving, next, cell);
        };
        along(g.i, span.i0, span.i1, g.x, g.dx, hn::And(leave, span.leaves_x));
        along(g.j, span.j0, span.j1, g.y, g.dy, hn::AndNot(span.leaves_x, leave));
        g.t = hn::IfThenElse(moving, t, g.t);
        if constexpr (!kRepeat)
            level = hn::IfThenElseZero(
                hn::RebindMask(IntTag(), Inside(bounds_, hn::Add(g.corner_x, g.i), hn::Add(g.corner_y, g.j))), level);
        g.level = hn::IfThenElse(hn::RebindMask(IntTag(), moving), level, g.level);
    }

    /// What rounding may do to a ray's depth below a plane or cell with slopes that sum up to `slopes`. Positions are
    /// wrong by < 2^-22 (1 + travel) texels: the roundings of origin, direction and their sum. Depths of ray and
    /// surface are wrong by < 2^-21. Both are doubled.
    ///
    /// Borders are crossed that many texels too early or too late, where the surface goes on with its neighbour's
    /// slopes instead. That moves a hit by as much, but loses none: on the border both agree, and only a hit that is
    /// just deep enough on one side alone could pass between, where its height over the surface turns within that
    /// distance, which is less than the error.
    HWY_INLINE static Vec ErrorAt(const Lanes& g, Vec t, Vec slopes) {
        const Vec misplaced = hn::MulAdd(hn::Mul(t, g.speed), Constant(0x1p-21f), Constant(0x1p-21f));
        return hn::MulAdd(slopes, misplaced, Constant(0x1p-20f));
    }

    // ---- steps

    HWY_INLINE void NodeStep(Lanes& g) {
        const Tag d;
        const IntTag di;
        const auto on_int = hn::Gt(g.level, hn::Zero(di));
        const Mask on = hn::RebindMask(d, on_int);
        const Int level = hn::Max(g.level, Whole(1));
        Vec cell_x = hn::Add(g.i, g.corner_x), cell_y = hn::Add(g.j, g.corner_y);
        if constexpr (kRepeat) {
            cell_x = Wrapped(cell_x, float(bounds_.columns));
            cell_y = Wrapped(cell_y, float(bounds_.rows));
        }
        const Vec side = PowerOfTwo(level);
        const Int column = hn::Shr(hn::IfThenElseZero(on_int, hn::ConvertTo(di, cell_x)), level),
                  row = hn::Shr(hn::IfThenElseZero(on_int, hn::ConvertTo(di, cell_y)), level);
        const Vec node_x = hn::Mul(hn::ConvertTo(d, column), side), node_y = hn::Mul(hn::ConvertTo(d, row), side);
        const Vec i0 = hn::Sub(g.i, hn::Sub(cell_x, node_x)), j0 = hn::Sub(g.j, hn::Sub(cell_y, node_y));
        const Span span = SpanIn(g, i0, hn::Add(i0, hn::Min(side, hn::Sub(Constant(float(bounds_.columns)), node_x))),
                                 j0, hn::Add(j0, hn::Min(side, hn::Sub(Constant(float(bounds_.rows)), node_y))));

        Int slopes, depths;
        GatherPairs<8>(bounds_.planes.data(),
                       hn::Add(first_of_[level], hn::Add(hn::Mul(row, columns_of_[level]), column)), slopes, depths);
        const Vec unit = PowerOfTwo(hn::Sub(Whole(-14), level));
        const Vec slope_u = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(hn::ShiftLeft<16>(slopes))), unit),
                  slope_v = hn::Mul(hn::ConvertTo(d, hn::ShiftRight<16>(slopes)), unit);
        const Vec middle = hn::Mul(hn::ConvertTo(d, hn::And(depths, Whole(0xffff))), Constant(0x1p-16f));
        const auto upper = hn::ShiftRight<16>(hn::BitCast(hn::RebindToUnsigned<Tag>(), depths));
        const Vec thickness = hn::Mul(hn::ConvertTo(d, hn::BitCast(di, upper)), Constant(0x1p-14f));

        // The ray's depth below the plane, at t and as it leaves.
        const Vec half = hn::Mul(side, Constant(0.5f));
        const Vec u = hn::MulAdd(g.t, g.dx, hn::Sub(g.x, hn::Add(i0, half))),
                  v = hn::MulAdd(g.t, g.dy, hn::Sub(g.y, hn::Add(j0, half)));
        const Vec error = ErrorAt(g, span.t_out, hn::Add(hn::Abs(slope_u), hn::Abs(slope_v)));
        const Vec sinking = hn::NegMulAdd(slope_u, g.dx, hn::NegMulAdd(slope_v, g.dy, g.ddepth));
        const Vec length = hn::Sub(span.t_out, g.t);
        const Vec below =
            hn::NegMulAdd(slope_u, u, hn::NegMulAdd(slope_v, v, hn::Sub(hn::MulAdd(g.t, g.ddepth, g.depth), middle)));
        const Vec below_out = hn::MulAdd(length, sinking, below);
        g.reads = hn::Sub(g.reads, hn::VecFromMask(di, on_int));

        Mask over = hn::And(on, hn::Lt(hn::Max(below, below_out), hn::Neg(error)));
        const Mask under = hn::AndNot(over, on);
        Mask done = hn::And(over, hn::Ge(span.t_out, g.t_last));
        if constexpr (kAny) {
            const Mask surely = hn::And(under, hn::Ge(hn::Max(below, below_out), hn::Add(thickness, error)));
            if (!hn::AllFalse(d, surely))
                results_.WriteHidden(g, surely);
        }
        const Vec zero = hn::Zero(d);
        // To the surface at the rate at which the ray sinks towards it.
        const Vec rate = hn::Max(hn::Max(sinking, Constant(1e-30f)), hn::Mul(g.speed, Constant(0x1p-12f)));
        const Vec per_rate = hn::Div(Constant(1), rate);
        const Vec until_dive = hn::Mul(hn::Max(hn::Sub(zero, hn::Add(below, error)), zero), per_rate);
        const Vec t_dive = hn::Min(hn::Add(g.t, until_dive), span.t_out);
        const Vec until_through = hn::Mul(hn::Sub(thickness, below), per_rate);
        const Vec in_slab = hn::Sub(hn::Min(hn::Add(g.t, until_through), span.t_out), t_dive);
        const Vec ahead = hn::Mul(hn::MulAdd(thickness, Constant(0.25f), hn::Neg(below_out)), per_rate);
        const Int closer = hn::Min(hn::Sub(level, Whole(1)),
                                   LevelOf(hn::Mul(hn::Mul(hn::Max(in_slab, zero), g.speed), Constant(2.f))));
        const Int farther = hn::Min(hn::Min(hn::Add(level, Whole(1)), top_level()),
                                    LevelOf(hn::Mul(hn::Mul(hn::Max(ahead, zero), g.speed), Constant(1.4f))));
        Move(g, span, on, over, hn::IfThenElse(over, span.t_out, t_dive),
             hn::IfThenElse(hn::RebindMask(di, over), farther, closer));
        Settle(g, done, over);
    }

    HWY_INLINE Int top_level() const { return Whole(int(bounds_.levels.size()) - 1); }

    HWY_INLINE void CellStep(Lanes& g, Mask on) {
        const Tag d;
        const IntTag di;
        const Vec zero = hn::Zero(d), one = Constant(1);
        const auto on_int = hn::RebindMask(di, on);
        Vec cell_x = hn::Add(g.i, g.corner_x), cell_y = hn::Add(g.j, g.corner_y);
        Vec i0 = g.i, j0 = g.j, i1 = hn::Add(g.i, one), j1 = hn::Add(g.j, one);
        if constexpr (kRepeat) {
            cell_x = Wrapped(cell_x, float(bounds_.columns));
            cell_y = Wrapped(cell_y, float(bounds_.rows));
        } else { // beyond the border, where depth does not vary along the axis, a cell goes on for ever
            const auto clamp = [&](Vec& cell, Vec& first, Vec& last, Vec corner, float count) {
                const Mask before = hn::Lt(cell, zero), after = hn::Ge(cell, Constant(count));
                first = hn::IfThenElse(before, Constant(-0x1p22f),
                                       hn::IfThenElse(after, hn::Sub(Constant(count), corner), first));
                last = hn::IfThenElse(after, Constant(0x1p22f), hn::IfThenElse(before, hn::Neg(corner), last));
                cell = hn::Max(zero, hn::Min(cell, Constant(count - 1)));
            };
            clamp(cell_x, i0, i1, g.corner_x, float(bounds_.columns));
            clamp(cell_y, j0, j1, g.corner_y, float(bounds_.rows));
        }
        const Span span = SpanIn(g, i0, i1, j0, j1);
        const Int column = hn::IfThenElseZero(on_int, hn::ConvertTo(di, cell_x)),
                  row = hn::IfThenElseZero(on_int, hn::ConvertTo(di, cell_y));
        const Int index = hn::Add(hn::Mul(row, Whole(bounds_.stride())), column);
        Int bits[4];
        GatherPairs<4>(bounds_.depths.data(), index, bits[0], bits[1]);
        GatherPairs<4>(bounds_.depths.data() + bounds_.stride(), index, bits[2], bits[3]);
        g.reads = hn::Sub(g.reads, hn::VecFromMask(di, on_int));
        const Vec d00 = hn::BitCast(d, bits[0]), d10 = hn::BitCast(d, bits[1]), d01 = hn::BitCast(d, bits[2]),
                  d11 = hn::BitCast(d, bits[3]);
        const Vec du = hn::Sub(d10, d00), dv = hn::Sub(d01, d00), duv = hn::Sub(hn::Sub(d11, d01), du);

        // The ray's depth below the surface, raised by the error: c + b s + a s², s = time - t.
        const Vec steepest_u = hn::Max(hn::Abs(du), hn::Abs(hn::Sub(d11, d01))),
                  steepest_v = hn::Max(hn::Abs(dv), hn::Abs(hn::Sub(d11, d10)));
        const Vec error = ErrorAt(g, span.t_out, hn::Add(steepest_u, steepest_v));
        const Vec u = hn::MulAdd(g.t, g.dx, hn::Sub(g.x, g.i)), v = hn::MulAdd(g.t, g.dy, hn::Sub(g.y, g.j));
        const Vec dv_here = hn::MulAdd(u, duv, dv), du_here = hn::MulAdd(v, duv, du);
        const Vec depth = hn::MulAdd(v, dv_here, hn::MulAdd(u, du, d00));
        const Vec below = hn::Sub(hn::MulAdd(g.t, g.ddepth, g.depth), depth);
        const Vec a = hn::Neg(hn::Mul(duv, hn::Mul(g.dx, g.dy))),
                  b = hn::NegMulAdd(du_here, g.dx, hn::NegMulAdd(dv_here, g.dy, g.ddepth)), c = hn::Add(below, error);
        const auto at = [&](Vec s) { return hn::MulAdd(s, hn::MulAdd(s, a, b), c); };
        const Vec length = hn::Sub(span.t_out, g.t), at_end = at(length);

        // The root where it begins to be below: of the two forms, the one that does not cancel.
        const Vec square = hn::NegMulAdd(hn::Mul(Constant(4), a), c, hn::Mul(b, b));
        const Vec root = hn::Sqrt(hn::Max(square, zero));
        const Mask sinks = hn::Ge(b, zero);
        const Vec over = hn::IfThenElse(sinks, hn::Mul(Constant(-2), c), hn::Sub(root, b)),
                  divisor = hn::IfThenElse(sinks, hn::Add(root, b), hn::Add(a, a));
        Vec s = hn::Div(over, divisor);
        const Mask crosses = hn::And(hn::And(hn::Ge(square, zero), hn::Gt(divisor, zero)), hn::Le(s, length));
        const Mask inside = hn::Ge(c, zero), ends_below = hn::Ge(at_end, zero);
        s = hn::IfThenElse(crosses, s, length);
        s = hn::IfThenZeroElse(inside, s);
        const Mask maybe = hn::And(on, hn::Or(inside, hn::Or(crosses, ends_below)));

        const Vec twice = hn::Add(error, error);
        Mask surely;
        if constexpr (kAny) {
            // The greatest depth below the surface on the way.
            const Vec top = hn::Div(b, hn::Mul(Constant(-2), a));
            const Mask arches = hn::And(hn::Lt(a, zero), hn::And(hn::Gt(top, zero), hn::Lt(top, length)));
            const Vec most = hn::Max(hn::Max(c, at_end), hn::IfThenElse(arches, at(top), c));
            surely = hn::And(maybe, hn::Ge(most, twice));
        } else {
            const Vec settled = hn::Min(length, hn::Add(s, hn::Div(Constant(kSettled), SettlingSpeed(g))));
            surely = hn::And(maybe, hn::Ge(at(settled), twice));
            // From the raised root to the true one.
            const Vec slope = hn::MulAdd(hn::Add(a, a), s, b);
            const Vec rest = hn::Div(hn::Sub(error, at(s)), slope);
            s = hn::IfThenElse(hn::And(hn::Gt(rest, zero), hn::Gt(slope, zero)), hn::Min(hn::Add(s, rest), settled), s);
        }
        const Mask doubts = hn::AndNot(surely, maybe);
        g.doubt = hn::IfThenElse(doubts, hn::Min(g.doubt, hn::Add(g.t, s)), g.doubt);
        const Mask misses = hn::AndNot(surely, on);
        if (!hn::AllFalse(d, surely)) {
            if constexpr (kAny) {
                results_.WriteHidden(g, surely);
            } else {
                const Vec t = hn::Add(g.t, s);
                const Mask settles = hn::Or(hn::Eq(g.doubt, Constant(kInfinity)),
                                            hn::Le(hn::Mul(hn::Sub(t, g.doubt), SettlingSpeed(g)), Constant(kSettled)));
                results_.WriteHits(g, hn::And(surely, settles), t, d00, du, dv, duv, cell_x, cell_y);
                results_.WriteDoubtful(g, hn::AndNot(settles, surely));
            }
        }
        const Mask done = hn::And(misses, hn::Ge(span.t_out, g.t_last));
        // The next one may be a node where the surface is more than a cell or two away.
        const Vec rate = hn::MulAdd(hn::Add(a, a), length, b);
        const Mask away = hn::Ge(hn::Mul(hn::Sub(error, at_end), hn::Mul(g.speed, Constant(0.7f))), rate);
        const Int next = hn::Min(top_level(), hn::IfThenElseZero(hn::RebindMask(di, away), Whole(1)));
        Move(g, span, misses, misses, span.t_out, next);
        Settle(g, done, misses);
    }

    /// How fast a doubt is left behind, in units of kSettled: by texels or by depth, whichever is faster.
    HWY_INLINE static Vec SettlingSpeed(const Lanes& g) {
        return hn::Max(g.speed, hn::Mul(hn::Abs(g.ddepth), Constant(kSettled / kSettledDepth)));
    }

    /// After a step: rays of `done` have come to their end, those of `passed` have left a node or cell without a hit.
    HWY_INLINE void Settle(Lanes& g, Mask done, Mask passed) {
        const Tag d;
        // No certain hit followed a doubt, or the way was too long for single precision.
        const Mask doubted = hn::Lt(g.doubt, Constant(kInfinity));
        Mask late = hn::And(doubted, hn::Gt(hn::Mul(hn::Sub(g.t, g.doubt), SettlingSpeed(g)), Constant(kSettled)));
        if constexpr (kAny) // any later hit settles it
            late = hn::Lt(g.speed, hn::Zero(d));
        const Mask cut = hn::Ge(hn::Mul(g.t, g.speed), Constant(kMostTravel * 0.999f));
        const Mask doubtful = hn::Or(hn::And(passed, late), hn::And(done, hn::Or(doubted, cut)));
        if (!hn::AllFalse(d, hn::Or(done, doubtful))) {
            results_.WriteDoubtful(g, doubtful);
            results_.WriteMisses(g, hn::AndNot(doubtful, done));
        }
    }

    const BoundPlanes& bounds_;
    HWY_ALIGN int first_[16], node_columns_[16];
    LevelTable first_of_, columns_of_;
    RayEntry<kRepeat> entry_;
    RayResults<kRepeat, kAny> results_;
};

} // namespace

void TraceStream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, ReliefHit* hits,
                 std::vector<DoubtfulRay>& doubtful) {
    if (bounds.wrap == HeightWrap::repeat)
        Stream<true, false>(bounds, rays, hits, nullptr, nullptr, doubtful).run();
    else
        Stream<false, false>(bounds, rays, hits, nullptr, nullptr, doubtful).run();
}

void OccludeStream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, std::uint8_t* hidden,
                   std::uint32_t* reads, std::vector<DoubtfulRay>& doubtful) {
    if (bounds.wrap == HeightWrap::repeat)
        Stream<true, true>(bounds, rays, nullptr, hidden, reads, doubtful).run();
    else
        Stream<false, true>(bounds, rays, nullptr, hidden, reads, doubtful).run();
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(TraceStream);
HWY_EXPORT(OccludeStream);

void trace_stream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, ReliefHit* hits,
                  std::vector<DoubtfulRay>& doubtful) {
    HWY_DYNAMIC_DISPATCH(TraceStream)(bounds, rays, hits, doubtful);
}

void occlude_stream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, std::uint8_t* hidden,
                    std::uint32_t* reads, std::vector<DoubtfulRay>& doubtful) {
    HWY_DYNAMIC_DISPATCH(OccludeStream)(bounds, rays, hidden, reads, doubtful);
}

} // namespace kokage
#endif

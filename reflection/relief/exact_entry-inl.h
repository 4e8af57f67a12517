// Rays on their way into lanes (exact_lanes-inl.h): where they enter the relief, in double precision, and which lane
// takes which. Per-target code of Google Highway: included once
// for every instruction set, so the guard toggles.
#include "reflection/relief/bound_planes.h"
#include "reflection/relief/exact_lanes-inl.h"
#include "reflection/relief/relief_ray.h"

#include <algorithm>
#include <span>

#include <hwy/highway.h>

#if defined(KOKAGE_EXACT_ENTRY_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KOKAGE_EXACT_ENTRY_INL_H
#undef KOKAGE_EXACT_ENTRY_INL_H
#else
#define KOKAGE_EXACT_ENTRY_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::exact_lanes::HWY_NAMESPACE {

constexpr double kCertainlyBelow = 1.125; ///< depth: below all surface, whatever the error

/// Whether cells lie where depths are stored; elsewhere a clamped tile repeats its border.
HWY_INLINE Mask Inside(const BoundPlanes& bounds, Vec i, Vec j) {
    const Vec zero = hn::Zero(Tag());
    return hn::And(hn::And(hn::Ge(i, zero), hn::Lt(i, Constant(float(bounds.columns)))),
                   hn::And(hn::Ge(j, zero), hn::Lt(j, Constant(float(bounds.rows)))));
}

/// Rays made ready for lanes.
struct ReadyRays {
    HWY_ALIGN float floats[kFloatFields][2 * kLanes];
    HWY_ALIGN int level[2 * kLanes], ray[2 * kLanes];
    std::size_t count = 0, next = 0;
};

/// Hands the rays of a stream to lanes that have none. `Results`: RayResults.
template <bool kRepeat>
class RayEntry {
  public:
    RayEntry(const BoundPlanes& bounds, std::span<const ReliefRay> rays) : bounds_(bounds), rays_(rays) {}

    HWY_INLINE bool has_rays() const { return ready_.next < ready_.count || next_ray_ < rays_.size(); }

    /// Idle lanes take the next rays, as far as some are left. Those that miss, or that single precision is not fit
    /// for, are told to the results at once.
    template <class Results>
    HWY_INLINE void Refill(Lanes& lanes, Mask idle, Results& results) {
        if (ready_.next == ready_.count) {
            Prepare(results);
            if (ready_.count == 0)
                return;
        }
        const Tag d;
        const IntTag di;
        // How many idle lanes stand before each lane: which of the ready rays it takes.
        const Int lane = hn::Iota(di, 0), idle_bits = Whole(int(Bits(idle)));
        const Int before = hn::And(idle_bits, hn::Sub(hn::Shl(Whole(1), lane), Whole(1)));
        const Int rank = hn::BitCast(di, hn::PopulationCount(hn::BitCast(hn::RebindToUnsigned<Tag>(), before)));
        const std::size_t left = ready_.count - ready_.next;
        const Mask takes = hn::And(idle, hn::RebindMask(d, hn::Lt(rank, Whole(int(std::min(left, kLanes))))));
        const auto index = hn::IndicesFromVec(di, rank);
        const auto index_f = hn::IndicesFromVec(d, rank);
        const auto fields = FieldsOf(lanes);
        for (std::size_t f = 0; f < kFloatFields; ++f) {
            const Vec next = hn::TableLookupLanes(hn::LoadU(d, ready_.floats[f] + ready_.next), index_f);
            *fields[f] = hn::IfThenElse(takes, next, *fields[f]);
        }
        const auto takes_int = hn::RebindMask(di, takes);
        lanes.level =
            hn::IfThenElse(takes_int, hn::TableLookupLanes(LoadInts(ready_.level + ready_.next), index), lanes.level);
        lanes.ray =
            hn::IfThenElse(takes_int, hn::TableLookupLanes(LoadInts(ready_.ray + ready_.next), index), lanes.ray);
        lanes.i = hn::IfThenZeroElse(takes, lanes.i);
        lanes.j = hn::IfThenZeroElse(takes, lanes.j);
        lanes.t = hn::IfThenZeroElse(takes, lanes.t);
        lanes.doubt = hn::IfThenElse(takes, Constant(kInfinity), lanes.doubt);
        lanes.reads = hn::IfThenZeroElse(takes_int, lanes.reads);
        ready_.next += std::min(left, hn::CountTrue(d, idle));
    }

  private:
    /// What a ray needs in double precision; half of the lanes.
    HWY_INLINE void Enter(const Double origin[3], const Double direction[3], Double t_most, RayState<Double, Int>& out,
                          Double& start_length, hn::Mask<DoubleTag>& misses, hn::Mask<DoubleTag>& odd) const {
        const DoubleTag d;
        const auto constant = [&](double value) { return hn::Set(d, value); };
        const Double zero = hn::Zero(d), never = constant(double(kInfinity));
        Double x = origin[0], y = origin[1];
        const Double z = origin[2], dz = direction[2];
        if constexpr (kRepeat) {
            x = hn::Sub(x, hn::Floor(x));
            y = hn::Sub(y, hn::Floor(y));
        }
        const auto above = hn::Lt(z, zero), down = hn::Gt(dz, zero), up = hn::Lt(dz, zero);
        const Double to_top = hn::Div(hn::Neg(z), dz);
        const Double t_first = hn::IfThenElseZero(above, hn::IfThenElse(down, to_top, never));
        Double t_last = t_most;
        // So that rays downwards do not end in doubt.
        const Double to_bottom = hn::Div(hn::Sub(constant(kCertainlyBelow), z), dz);
        t_last = hn::IfThenElse(down, hn::Min(t_last, hn::Max(to_bottom, t_first)), t_last);
        t_last = hn::IfThenElse(up, hn::Min(t_last, hn::Max(zero, to_top)), t_last);
        const Double tiles = hn::Max(hn::Abs(direction[0]), hn::Abs(direction[1]));
        const auto moves = hn::Gt(tiles, zero);
        t_last = hn::IfThenElse(
            moves, hn::Min(t_last, hn::Add(t_first, hn::Div(constant(double(kMostTilesCrossed)), tiles))), t_last);
        misses = hn::Or(hn::Gt(t_first, t_last), hn::Eq(t_first, never));

        const Double width = constant(bounds_.width), height = constant(bounds_.height);
        const Double half = constant(kRepeat ? 0.5 : -0.5); // cells begin half a texel outside of a clamped tile
        Double dx = hn::Mul(direction[0], width), dy = hn::Mul(direction[1], height);
        x = hn::MulAdd(t_first, dx, hn::Sub(hn::Mul(x, width), half));
        y = hn::MulAdd(t_first, dy, hn::Sub(hn::Mul(y, height), half));
        const Double floor_x = hn::Floor(x), floor_y = hn::Floor(y);
        out.x = hn::Sub(x, floor_x);
        out.y = hn::Sub(y, floor_y);
        out.corner_x = floor_x;
        out.corner_y = floor_y;
        if constexpr (kRepeat) {
            out.corner_x = hn::Sub(floor_x, hn::Mul(width, hn::Floor(hn::Div(floor_x, width))));
            out.corner_y = hn::Sub(floor_y, hn::Mul(height, hn::Floor(hn::Div(floor_y, height))));
        }
        const Double far = hn::Max(hn::Abs(floor_x), hn::Abs(floor_y));
        out.depth = hn::MulAdd(t_first, dz, z);
        // Components that could not move a ray by 2^-20 texels on its way are none.
        const Double speed = hn::Max(hn::Abs(dx), hn::Abs(dy)), fastest = hn::Max(speed, hn::Abs(dz));
        const Double slight = hn::Mul(fastest, constant(0x1p-40));
        const auto still_x = hn::Le(hn::Abs(dx), slight), still_y = hn::Le(hn::Abs(dy), slight);
        dx = hn::IfThenZeroElse(still_x, dx);
        dy = hn::IfThenZeroElse(still_y, dy);
        out.dx = dx;
        out.dy = dy;
        out.ddepth = dz;
        out.dt_x = hn::IfThenElse(still_x, constant(kFarAway), hn::Div(constant(1), dx));
        out.dt_y = hn::IfThenElse(still_y, constant(kFarAway), hn::Div(constant(1), dy));
        out.speed = hn::Max(hn::Abs(dx), hn::Abs(dy));
        out.t_last = hn::Min(hn::Sub(t_last, t_first), hn::Div(constant(double(kMostTravel)), out.speed));
        out.t_entered = t_first;
        start_length = hn::IfThenElse(down, hn::Div(hn::Mul(constant(0.7), out.speed), dz), zero);
        // Comparisons that fail for what is not a number.
        odd = hn::Not(hn::And(hn::And(hn::Ge(fastest, constant(0x1p-40)), hn::Le(fastest, constant(0x1p40))),
                              hn::And(hn::Le(far, constant(kRepeat ? 0x1p23 : 0x1p20)), hn::Eq(t_most, t_most))));
        odd = hn::Or(odd, hn::Not(hn::And(hn::Le(hn::Abs(z), constant(0x1p20)), hn::Lt(out.t_last, never))));
    }

    template <class Results>
    HWY_INLINE void Prepare(Results& results) {
        const Tag d;
        const IntTag di;
        const std::size_t count = std::min(kLanes, rays_.size() - next_ray_);
        const ReliefRay* from = rays_.data() + next_ray_;
        ReliefRay few[kLanes];
        if (count < kLanes) {
            std::copy_n(from, count, few);
            from = few;
        }
        static_assert(sizeof(ReliefRay) == 7 * sizeof(float));
        const Int lane = hn::Iota(di, 0), place = hn::Mul(lane, Whole(7));
        Vec given[7];
        for (int k = 0; k < 7; ++k)
            given[k] = hn::GatherIndex(d, reinterpret_cast<const float*>(from) + k, place);

        RayState<Double, Int> halves[2];
        Double start[2];
        Mask misses, odd;
        {
            const HalfTag half;
            hn::Mask<DoubleTag> half_misses[2], half_odd[2];
            for (int h = 0; h < 2; ++h) {
                const auto part = [&](Vec v) {
                    return hn::PromoteTo(DoubleTag(), h ? hn::UpperHalf(half, v) : hn::LowerHalf(half, v));
                };
                const Double origin[3] = {part(given[0]), part(given[1]), part(given[2])},
                             direction[3] = {part(given[3]), part(given[4]), part(given[5])};
                Enter(origin, direction, part(given[6]), halves[h], start[h], half_misses[h], half_odd[h]);
            }
            const auto joined = [&](const hn::Mask<DoubleTag>* parts) {
                const DoubleTag dd;
                const auto narrow = [&](hn::Mask<DoubleTag> m) {
                    return hn::DemoteTo(half, hn::IfThenElseZero(m, hn::Set(dd, 1.)));
                };
                return hn::Gt(hn::Combine(d, narrow(parts[1]), narrow(parts[0])), hn::Zero(d));
            };
            misses = joined(half_misses);
            odd = joined(half_odd);
        }
        for (int k = 0; k < 6; ++k)
            odd = hn::Or(odd, hn::Not(hn::Le(hn::Abs(given[k]), Constant(std::numeric_limits<float>::max()))));
        const Mask there = hn::RebindMask(d, hn::Lt(lane, Whole(int(count))));
        odd = hn::And(odd, there);
        const Mask alive = hn::And(there, hn::Not(hn::Or(odd, misses)));
        misses = hn::And(there, hn::AndNot(odd, misses));
        ForEach(misses, [&](std::size_t l) { results.WriteMiss(next_ray_ + l, 0); });
        ForEach(odd, [&](std::size_t l) { results.WriteUnfit(next_ray_ + l); });

        const auto fields0 = FieldsOf(halves[0]), fields1 = FieldsOf(halves[1]);
        const auto joined = [&](Double low, Double high) {
            const HalfTag half;
            return hn::Combine(d, hn::DemoteTo(half, high), hn::DemoteTo(half, low));
        };
        for (std::size_t f = 0; f < kFloatFields; ++f)
            hn::CompressStore(joined(*fields0[f], *fields1[f]), alive, d, ready_.floats[f]);
        const Int top = Whole(int(bounds_.levels.size()) - 1);
        Int level = hn::Min(hn::Max(LevelOf(joined(start[0], start[1])), Whole(1)), top);
        if constexpr (!kRepeat)
            level = hn::IfThenElseZero(
                hn::RebindMask(di, Inside(bounds_, joined(*fields0[0], *fields1[0]), joined(*fields0[1], *fields1[1]))),
                level);
        hn::CompressStore(level, hn::RebindMask(di, alive), di, ready_.level);
        ready_.count =
            hn::CompressStore(hn::Add(lane, Whole(int(next_ray_))), hn::RebindMask(di, alive), di, ready_.ray);
        ready_.next = 0;
        next_ray_ += count;
    }

    const BoundPlanes& bounds_;
    std::span<const ReliefRay> rays_;
    std::size_t next_ray_ = 0;
    ReadyRays ready_;
};
} // namespace kokage::exact_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

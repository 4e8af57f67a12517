#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/relief/exact_stream.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "reflection/relief/exact_stream.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

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

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 16>;
using IntTag = hn::RebindToSigned<Tag>;
using HalfTag = hn::Half<Tag>;
using DoubleTag = hn::Rebind<double, HalfTag>;
using LongTag = hn::RebindToSigned<DoubleTag>;
using Vec = hn::Vec<Tag>;
using Int = hn::Vec<IntTag>;
using Double = hn::Vec<DoubleTag>;
using Mask = hn::Mask<Tag>;
constexpr std::size_t kLanes = hn::MaxLanes(Tag());

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kFarAway = 1e30f;           ///< times of borders that are never reached
constexpr float kSettled = 0.125f;          ///< texels between a doubt and a certain hit that settles it
constexpr float kSettledDepth = 1.f / 1024; ///< depth between both: steep rays beside walls get deep within a texel
constexpr float kMostTravel = 1 << 14;      ///< texels that single precision is trusted with
constexpr double kCertainlyBelow = 1.125;   ///< depth: below all surface, whatever the error

HWY_INLINE Vec Constant(float value) {
    return hn::Set(Tag(), value);
}
HWY_INLINE Int Whole(int value) {
    return hn::Set(IntTag(), value);
}
/// 2^exponent.
HWY_INLINE Vec PowerOfTwo(Int exponent) {
    return hn::BitCast(Tag(), hn::ShiftLeft<23>(hn::Add(exponent, Whole(127))));
}
/// The level whose nodes are as wide as a length >= 0 in texels, or half of it; 0 below 2.
HWY_INLINE Int LevelOf(Vec length) {
    return hn::Max(hn::Sub(hn::ShiftRight<23>(hn::BitCast(IntTag(), length)), Whole(127)), hn::Zero(IntTag()));
}
HWY_INLINE std::uint32_t Bits(Mask mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(Tag(), mask, bytes);
    std::uint32_t bits;
    std::memcpy(&bits, bytes, sizeof bits);
    return bits;
}
HWY_INLINE Int LoadInts(const int* from) {
    return hn::LoadU(IntTag(), from);
}

/// Sixteen numbers, looked up by level.
class LevelTable {
  public:
    HWY_INLINE void set(const int* values) {
        values_ = values;
        if constexpr (kLanes == 16)
            vector_ = LoadInts(values);
    }
    HWY_INLINE Int operator[](Int level) const {
        if constexpr (kLanes == 16)
            return hn::TableLookupLanes(vector_, hn::IndicesFromVec(IntTag(), level));
        else
            return hn::GatherIndex(IntTag(), values_, level);
    }

  private:
    const int* values_ = nullptr;
    Int vector_;
};

/// Two neighbours in memory, of 32 bits each, for every lane; `index` counts units of `kUnit` bytes.
template <int kUnit>
HWY_INLINE void GatherPairs(const void* base, Int index, Int& first, Int& second) {
    if constexpr (kLanes >= 8) {
        const LongTag dl;
        const HalfTag half;
        const hn::RebindToSigned<HalfTag> half_int;
        const auto* longs = static_cast<const std::int64_t*>(base);
        const auto gather = [&](hn::Vec<decltype(half_int)> part) {
            const auto offset = hn::PromoteTo(dl, part);
            return hn::BitCast(IntTag(), hn::GatherOffset(dl, longs, hn::ShiftLeft < kUnit == 8 ? 3 : 2 > (offset)));
        };
        (void)half;
        const Int low = gather(hn::LowerHalf(half_int, index)), high = gather(hn::UpperHalf(half_int, index));
        first = hn::ConcatEven(IntTag(), high, low);
        second = hn::ConcatOdd(IntTag(), high, low);
    } else {
        const auto* ints = static_cast<const int*>(base);
        const Int scaled = kUnit == 8 ? hn::Add(index, index) : index;
        first = hn::GatherIndex(IntTag(), ints, scaled);
        second = hn::GatherIndex(IntTag(), ints, hn::Add(scaled, Whole(1)));
    }
}

/// Rays in the relief, x and y in cells and counted from the corner of the cell where they enter it, so that the digits
/// of a far corner are not lost.
template <class Float, class Integer>
struct RayState {
    Float corner_x, corner_y; ///< of the cell of entry
    Float x, y, depth;        ///< the entry, at t = 0; x and y in [0, 1]
    Float dx, dy, ddepth;
    Float dt_x, dt_y;        ///< per cell; kFarAway where the ray does not move
    Float speed;             ///< cells, along the axis where it moves faster
    Float t_last, t_entered; ///< entry after the ray's origin
    Integer level, ray;
};

constexpr int kFloatFields = 13;

/// Rays made ready for lanes.
struct ReadyRays {
    HWY_ALIGN float floats[kFloatFields][2 * kLanes];
    HWY_ALIGN int level[2 * kLanes], ray[2 * kLanes];
    std::size_t count = 0, next = 0;
};

/// kFloatFields of a state, in one order.
template <class State>
HWY_INLINE auto FieldsOf(State& s) {
    return std::array{&s.corner_x, &s.corner_y, &s.x,    &s.y,     &s.depth,  &s.dx,       &s.dy,
                      &s.ddepth,   &s.dt_x,     &s.dt_y, &s.speed, &s.t_last, &s.t_entered};
}

struct Lanes : RayState<Vec, Int> {
    Vec i, j;  ///< the cell, from the entry's
    Vec t;     ///< nothing is hit before
    Vec doubt; ///< when the first doubt arose; kInfinity: none
    Int reads; ///< level is -1 where there is no ray
};

template <bool kRepeat, bool kAny>
class Stream {
  public:
    Stream(const BoundPlanes& bounds, std::span<const ReliefRay> rays, ReliefHit* hits, std::uint8_t* hidden,
           std::uint32_t* reads, std::vector<DoubtfulRay>& doubtful)
        : bounds_(bounds), rays_(rays), hits_(hits), hidden_(hidden), reads_(reads), doubtful_(doubtful) {
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
        while (idle_count >= kRefill && (ready_.next < ready_.count || next_ray_ < rays_.size())) {
            Refill(lanes, idle);
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

    // ---- rays into lanes

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

    HWY_INLINE void Prepare() {
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
        ForEach(misses, [&](std::size_t l) { WriteMiss(next_ray_ + l, 0); });
        ForEach(odd, [&](std::size_t l) {
            WriteMiss(next_ray_ + l, 0);
            doubtful_.push_back({next_ray_ + l, 0});
        });

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
                hn::RebindMask(di, Inside(joined(*fields0[0], *fields1[0]), joined(*fields0[1], *fields1[1]))), level);
        hn::CompressStore(level, hn::RebindMask(di, alive), di, ready_.level);
        ready_.count =
            hn::CompressStore(hn::Add(lane, Whole(int(next_ray_))), hn::RebindMask(di, alive), di, ready_.ray);
        ready_.next = 0;
        next_ray_ += count;
    }

    HWY_INLINE void Refill(Lanes& lanes, Mask idle) {
        if (ready_.next == ready_.count) {
            Prepare();
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

    // ---- places

    /// Whether cells lie where depths are stored; elsewhere a clamped tile repeats its border.
    HWY_INLINE Mask Inside(Vec i, Vec j) const {
        const Vec zero = hn::Zero(Tag());
        return hn::And(hn::And(hn::Ge(i, zero), hn::Lt(i, Constant(float(bounds_.columns)))),
                       hn::And(hn::Ge(j, zero), hn::Lt(j, Constant(float(bounds_.rows)))));
    }

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
                hn::RebindMask(IntTag(), Inside(hn::Add(g.corner_x, g.i), hn::Add(g.corner_y, g.j))), level);
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
                WriteHidden(g, surely);
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
                WriteHidden(g, surely);
            } else {
                const Vec t = hn::Add(g.t, s);
                const Mask settles = hn::Or(hn::Eq(g.doubt, Constant(kInfinity)),
                                            hn::Le(hn::Mul(hn::Sub(t, g.doubt), SettlingSpeed(g)), Constant(kSettled)));
                WriteHits(g, hn::And(surely, settles), t, d00, du, dv, duv, cell_x, cell_y);
                WriteDoubtful(g, hn::AndNot(settles, surely));
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
            WriteDoubtful(g, doubtful);
            WriteMisses(g, hn::AndNot(doubtful, done));
        }
    }

    // ---- rays out of lanes

    template <class Body>
    HWY_INLINE static void ForEach(Mask mask, Body&& body) {
        for (std::uint32_t bits = Bits(mask); bits; bits &= bits - 1)
            body(std::size_t(hwy::Num0BitsBelowLS1Bit_Nonzero32(bits)));
    }
    HWY_INLINE static void Retire(Lanes& g, Mask mask) {
        g.level = hn::IfThenElse(hn::RebindMask(IntTag(), mask), Whole(-1), g.level);
    }
    HWY_INLINE void WriteMiss(std::size_t ray, int reads) const {
        if constexpr (kAny) {
            hidden_[ray] = 0;
            if (reads_)
                reads_[ray] = std::uint32_t(reads);
        } else {
            hits_[ray] = ReliefHit();
            hits_[ray].reads = std::uint32_t(reads);
        }
    }
    /// rays() and reads() of lanes in memory.
    struct Names {
        HWY_ALIGN int ray[kLanes], reads[kLanes];
        HWY_INLINE explicit Names(const Lanes& g) {
            hn::Store(g.ray, IntTag(), ray);
            hn::Store(g.reads, IntTag(), reads);
        }
    };
    HWY_INLINE void WriteMisses(Lanes& g, Mask mask) const {
        const Names names(g);
        ForEach(mask, [&](std::size_t l) { WriteMiss(std::size_t(names.ray[l]), names.reads[l]); });
        Retire(g, mask);
    }
    HWY_INLINE void WriteDoubtful(Lanes& g, Mask mask) {
        if (HWY_LIKELY(hn::AllFalse(Tag(), mask)))
            return;
        const Names names(g);
        HWY_ALIGN float t[kLanes];
        hn::Store(hn::Min(g.doubt, g.t), Tag(), t);
        ForEach(mask, [&](std::size_t l) {
            WriteMiss(std::size_t(names.ray[l]), names.reads[l]);
            doubtful_.push_back({std::size_t(names.ray[l]), t[l]});
        });
        Retire(g, mask);
    }
    HWY_INLINE void WriteHidden(Lanes& g, Mask mask) const {
        const Names names(g);
        ForEach(mask, [&](std::size_t l) {
            hidden_[names.ray[l]] = 1;
            if (reads_)
                reads_[names.ray[l]] = std::uint32_t(names.reads[l]);
        });
        Retire(g, mask);
    }
    HWY_INLINE void WriteHits(Lanes& g, Mask mask, Vec t, Vec d00, Vec du, Vec dv, Vec duv, Vec cell_x,
                              Vec cell_y) const {
        const Tag d;
        const Vec zero = hn::Zero(d), one = Constant(1), half = Constant(0.5f);
        const Vec width = Constant(float(bounds_.width)), height = Constant(float(bounds_.height));
        const Vec from_x = hn::MulAdd(t, g.dx, hn::Sub(g.x, g.i)), from_y = hn::MulAdd(t, g.dy, hn::Sub(g.y, g.j));
        const Vec u = hn::Max(zero, hn::Min(from_x, one)), v = hn::Max(zero, hn::Min(from_y, one));
        Vec at_x, at_y;
        if constexpr (kRepeat) {
            const auto wrapped = [&](Vec cell, Vec inside, Vec count) {
                const Vec at = hn::Div(hn::Add(cell, hn::Add(inside, half)), count);
                return hn::IfThenElse(hn::Ge(at, one), hn::Sub(at, one), at);
            };
            at_x = wrapped(cell_x, u, width);
            at_y = wrapped(cell_y, v, height);
        } else { // the first cell begins half a texel outside
            at_x = hn::Div(hn::Sub(hn::Add(hn::Add(g.corner_x, g.i), from_x), half), width);
            at_y = hn::Div(hn::Sub(hn::Add(hn::Add(g.corner_y, g.j), from_y), half), height);
        }
        const Vec slope_u = hn::MulAdd(v, duv, du), slope_v = hn::MulAdd(u, duv, dv);
        const Vec fields[6] = {hn::Add(g.t_entered, t),
                               at_x,
                               at_y,
                               hn::MulAdd(v, slope_v, hn::MulAdd(u, du, d00)),
                               hn::Mul(slope_u, width),
                               hn::Mul(slope_v, height)};
        HWY_ALIGN float values[6][kLanes];
        for (int f = 0; f < 6; ++f)
            hn::Store(fields[f], d, values[f]);
        const Names names(g);
        ForEach(mask, [&](std::size_t l) {
            hits_[names.ray[l]] = {values[0][l],
                                   {values[1][l], values[2][l]},
                                   values[3][l],
                                   {values[4][l], values[5][l]},
                                   std::uint32_t(names.reads[l])};
        });
        Retire(g, mask);
    }

    const BoundPlanes& bounds_;
    std::span<const ReliefRay> rays_;
    ReliefHit* hits_;
    std::uint8_t* hidden_;
    std::uint32_t* reads_;
    std::vector<DoubtfulRay>& doubtful_;
    std::size_t next_ray_ = 0;
    HWY_ALIGN int first_[16], node_columns_[16];
    LevelTable first_of_, columns_of_;
    ReadyRays ready_;
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

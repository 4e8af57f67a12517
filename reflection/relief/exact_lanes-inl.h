// Rays on bound planes in the lanes of vectors (exact_stream.cpp). Per-target code of Google Highway: included once
// for every instruction set, so the guard toggles.
#include "reflection/relief/lane_vectors-inl.h"

#include <array>
#include <limits>

#include <hwy/highway.h>

#if defined(KOKAGE_EXACT_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KOKAGE_EXACT_LANES_INL_H
#undef KOKAGE_EXACT_LANES_INL_H
#else
#define KOKAGE_EXACT_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::exact_lanes::HWY_NAMESPACE {

using namespace relief_lanes::HWY_NAMESPACE;

using HalfTag = hn::Half<Tag>;
using DoubleTag = hn::Rebind<double, HalfTag>;
using LongTag = hn::RebindToSigned<DoubleTag>;
using Double = hn::Vec<DoubleTag>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kFarAway = 1e30f;      ///< times of borders that are never reached
constexpr float kMostTravel = 1 << 14; ///< texels that single precision is trusted with

/// 2^exponent.
HWY_INLINE Vec PowerOfTwo(Int exponent) {
    return hn::BitCast(Tag(), hn::ShiftLeft<23>(hn::Add(exponent, Whole(127))));
}
/// The level whose nodes are as wide as a length >= 0 in texels, or half of it; 0 below 2.
HWY_INLINE Int LevelOf(Vec length) {
    return hn::Max(hn::Sub(hn::ShiftRight<23>(hn::BitCast(IntTag(), length)), Whole(127)), hn::Zero(IntTag()));
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
} // namespace kokage::exact_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

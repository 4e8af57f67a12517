// Rays on relief in the lanes of vectors, for methods that step along them: a lane whose ray is done takes the next one
// of the stream. Per-target code of Google Highway: included once for every instruction set, so the guard toggles.
#include "reflection/relief/lane_rays.h"
#include "reflection/relief/lane_vectors-inl.h"
#include "reflection/relief/padded_depths.h"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

#if defined(KOKAGE_RAY_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KOKAGE_RAY_LANES_INL_H
#undef KOKAGE_RAY_LANES_INL_H
#else
#define KOKAGE_RAY_LANES_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::relief_lanes::HWY_NAMESPACE {

/// Two neighbours in memory for every lane: index and index + 1.
HWY_INLINE void GatherPairs(const float* base, Int index, Vec& first, Vec& second) {
    if constexpr (kLanes >= 8) { // half as many accesses
        const hn::Half<IntTag> half;
        const hn::RebindToSigned<hn::Rebind<double, hn::Half<Tag>>> dl;
        const auto gather = [&](hn::Vec<decltype(half)> part) {
            return hn::BitCast(Tag(), hn::GatherOffset(dl, reinterpret_cast<const std::int64_t*>(base),
                                                       hn::ShiftLeft<2>(hn::PromoteTo(dl, part))));
        };
        const Vec low = gather(hn::LowerHalf(half, index)), high = gather(hn::UpperHalf(half, index));
        first = hn::ConcatEven(Tag(), high, low);
        second = hn::ConcatOdd(Tag(), high, low);
    } else {
        first = hn::GatherIndex(Tag(), base, index);
        second = hn::GatherIndex(Tag(), base, hn::Add(index, Whole(1)));
    }
}

/// Where rays stand over the texels: the cell's first texel, and the place in the cell.
struct Place {
    Vec column, row, a, b;
};

template <bool kRepeat>
HWY_INLINE void PlaceAlong(Vec at, float count, Vec& texel, Vec& inside) {
    const Vec last = Constant(count - 1), zero = hn::Zero(Tag());
    if constexpr (kRepeat) {
        const Vec floor = hn::Floor(at);
        inside = hn::Sub(at, floor);
        const Vec tile = hn::Floor(hn::Mul(hn::Add(floor, Constant(0.5f)), Constant(1 / count)));
        // Rounding of 1/count may take the texels beside the tile's edge for the next tile's.
        texel = hn::Max(zero, hn::Min(hn::NegMulAdd(tile, Constant(count), floor), last));
    } else {
        const Vec nearest = hn::Max(zero, hn::Min(at, last));
        texel = hn::Floor(nearest);
        inside = hn::Sub(nearest, texel);
    }
}

template <bool kRepeat>
HWY_INLINE Place PlaceOf(const PaddedDepths& field, Vec x, Vec y) {
    Place place;
    PlaceAlong<kRepeat>(x, float(field.width), place.column, place.a);
    PlaceAlong<kRepeat>(y, float(field.height), place.row, place.b);
    return place;
}

/// bilinear_cell.h's.
struct Cells {
    Vec d00, du, dv, duv;

    HWY_INLINE Vec slope_a(Vec b) const { return hn::MulAdd(b, duv, du); }
    HWY_INLINE Vec slope_b(Vec a) const { return hn::MulAdd(a, duv, dv); }
    HWY_INLINE Vec depth(Vec a, Vec b) const { return hn::MulAdd(b, slope_b(a), hn::MulAdd(a, du, d00)); }
};

HWY_INLINE Int IndexOf(const Place& place, int stride) {
    const IntTag di;
    return hn::Add(hn::Mul(hn::ConvertTo(di, place.row), Whole(stride)), hn::ConvertTo(di, place.column));
}

HWY_INLINE Cells CellsAt(const PaddedDepths& field, const Place& place) {
    const Int index = IndexOf(place, field.stride());
    Vec d00, d10, d01, d11;
    GatherPairs(field.depths.data(), index, d00, d10);
    GatherPairs(field.depths.data() + field.stride(), index, d01, d11);
    return {d00, hn::Sub(d10, d00), hn::Sub(d01, d00), hn::Sub(hn::Sub(d11, d10), hn::Sub(d01, d00))};
}

/// Rays from where they enter the relief, x and y in texels (centres at whole numbers).
struct Rays {
    Vec x, y, depth, dx, dy, ddepth;
    Vec t_last; ///< nothing can be hit beyond, counted from the entry
    Vec t_base; ///< of the entry
    Int ray;    ///< of the stream; -1: the lane is idle
    Int reads;
};
constexpr std::size_t kFields = 8;
HWY_INLINE std::array<Vec*, kFields> FieldsOf(Rays& r) {
    return {&r.x, &r.y, &r.depth, &r.dx, &r.dy, &r.ddepth, &r.t_last, &r.t_base};
}

/// What a ray hit, in lanes.
struct Found {
    Vec t, depth, slope_u, slope_v; ///< t from the entry on; slopes per texel
};

/// `Steps` holds a method's own lanes:
///   Start(rays, lanes)                 rays that lanes begin with
///   Step(rays, hit, missed) -> Found   one step of all lanes that are not idle; counts reads
template <bool kRepeat, class Steps>
class RayStream {
  public:
    RayStream(const PaddedDepths& field, std::span<const ReliefRay> rays, const LaneResults& results, Steps steps)
        : field_(field), given_(rays), results_(results), steps_(steps) {}

    void run() {
        Rays rays;
        for (Vec* value : FieldsOf(rays))
            *value = hn::Zero(Tag());
        rays.ray = Whole(-1);
        rays.reads = Whole(0);
        for (;;) {
            const Mask idle = hn::RebindMask(Tag(), hn::Lt(rays.ray, Whole(0)));
            const std::size_t idle_count = hn::CountTrue(Tag(), idle);
            if (idle_count >= kRefill && (ready_.next < ready_.count || next_given_ < given_.size())) {
                Refill(rays, idle);
                continue;
            }
            if (idle_count == kLanes)
                return;
            Mask hit, missed;
            const Found found = steps_.Step(rays, hit, missed);
            hit = hn::AndNot(idle, hit);
            missed = hn::AndNot(idle, missed);
            if (!hn::AllFalse(Tag(), hit))
                WriteHits(rays, hit, found);
            if (!hn::AllFalse(Tag(), missed))
                WriteMisses(rays, missed);
        }
    }

  private:
    static constexpr std::size_t kRefill = std::max<std::size_t>(1, kLanes / 4);

    /// As relief_ray.h and cell_by_cell.cpp's texel_ray.
    HWY_INLINE Rays Enter(const Vec given[7], Mask& missed, Mask& odd) const {
        const Vec zero = hn::Zero(Tag()), width = Constant(float(field_.width)),
                  height = Constant(float(field_.height));
        Vec u = given[0], v = given[1];
        const Vec z = given[2], du = given[3], dv = given[4], dz = given[5];
        if constexpr (kRepeat) {
            u = hn::Sub(u, hn::Floor(u));
            v = hn::Sub(v, hn::Floor(v));
        }
        const Mask above = hn::Lt(z, zero), down = hn::Gt(dz, zero), up = hn::Lt(dz, zero);
        Rays r;
        const Vec to_top = hn::Div(hn::Neg(z), dz);
        missed = hn::And(above, hn::Not(down));
        r.t_base = hn::IfThenElseZero(hn::And(above, down), to_top);
        r.depth = hn::Max(z, zero);
        r.dx = hn::Mul(du, width);
        r.dy = hn::Mul(dv, height);
        r.ddepth = dz;
        r.x = hn::MulAdd(r.t_base, r.dx, hn::MulSub(u, width, Constant(0.5f)));
        r.y = hn::MulAdd(r.t_base, r.dy, hn::MulSub(v, height, Constant(0.5f)));
        const Vec tiles = hn::Max(hn::Abs(du), hn::Abs(dv));
        Vec last = hn::Sub(hn::Min(given[6], Constant(std::numeric_limits<float>::max())), r.t_base);
        last = hn::IfThenElse(down, hn::Min(last, hn::Max(zero, hn::Div(hn::Sub(Constant(kBelowAll), r.depth), dz))),
                              last);
        last = hn::IfThenElse(up, hn::Min(last, hn::Max(zero, to_top)), last);
        last = hn::IfThenElse(hn::Gt(tiles, zero), hn::Min(last, hn::Div(Constant(kMostTilesCrossed), tiles)), last);
        r.t_last = hn::IfThenElse(hn::Eq(hn::Max(tiles, hn::Abs(dz)), zero), hn::Min(last, zero), last);
        missed = hn::Or(missed, hn::Lt(r.t_last, zero));
        // Comparisons that fail for what is not a number.
        const Vec fastest = hn::Max(tiles, hn::Abs(dz)), far = hn::Max(hn::Abs(r.x), hn::Abs(r.y));
        odd = hn::Not(hn::And(hn::And(hn::Ge(fastest, Constant(1e-9f)), hn::Le(fastest, Constant(1e9f))),
                              hn::And(hn::Le(far, Constant(kFarTexels)), hn::Eq(given[6], given[6]))));
        odd = hn::Or(
            odd, hn::Not(hn::And(hn::Le(hn::Abs(z), Constant(1e9f)), hn::Eq(hn::Add(hn::Add(u, v), hn::Add(du, dv)),
                                                                            hn::Add(hn::Add(u, v), hn::Add(du, dv))))));
        return r;
    }

    HWY_INLINE void Prepare() {
        const Tag d;
        const IntTag di;
        const std::size_t count = std::min(kLanes, given_.size() - next_given_);
        const ReliefRay* from = given_.data() + next_given_;
        std::array<ReliefRay, kLanes> few;
        if (count < kLanes) {
            std::copy_n(from, count, few.begin());
            from = few.data();
        }
        static_assert(sizeof(ReliefRay) == 7 * sizeof(float));
        const Int lane = hn::Iota(di, 0);
        Vec given[7];
        for (int k = 0; k < 7; ++k)
            given[k] = hn::GatherIndex(d, reinterpret_cast<const float*>(from) + k, hn::Mul(lane, Whole(7)));
        Mask missed, odd;
        Rays rays = Enter(given, missed, odd);
        rays.ray = hn::Add(lane, Whole(int(next_given_)));
        rays.reads = Whole(0);
        const Mask there = hn::RebindMask(d, hn::Lt(lane, Whole(int(count))));
        odd = hn::And(odd, there);
        missed = hn::AndNot(odd, hn::And(missed, there));
        for (std::uint32_t bits = Bits(odd); bits != 0; bits &= bits - 1)
            results_.odd->push_back(next_given_ + std::size_t(__builtin_ctz(bits)));
        next_given_ += count;
        const Mask ready = hn::AndNot(odd, hn::AndNot(missed, there));
        const auto fields = FieldsOf(rays);
        for (std::size_t f = 0; f < kFields; ++f)
            hn::CompressStore(*fields[f], ready, d, ready_.fields[f]);
        ready_.count = hn::CompressStore(rays.ray, hn::RebindMask(di, ready), di, ready_.ray);
        ready_.next = 0;
        if (!hn::AllFalse(d, missed))
            WriteMisses(rays, missed);
    }

    HWY_INLINE void Refill(Rays& rays, Mask idle) {
        if (ready_.next == ready_.count) {
            Prepare();
            if (ready_.count == 0)
                return;
        }
        const Tag d;
        const IntTag di;
        // How many idle lanes stand before each lane: which of the ready rays it takes.
        const Int lane = hn::Iota(di, 0);
        const Int before = hn::And(Whole(int(Bits(idle))), hn::Sub(hn::Shl(Whole(1), lane), Whole(1)));
        const Int rank = hn::BitCast(di, hn::PopulationCount(hn::BitCast(hn::RebindToUnsigned<Tag>(), before)));
        const std::size_t left = ready_.count - ready_.next;
        const Mask takes = hn::And(idle, hn::RebindMask(d, hn::Lt(rank, Whole(int(std::min(left, kLanes))))));
        const auto fields = FieldsOf(rays);
        for (std::size_t f = 0; f < kFields; ++f) {
            const Vec next =
                hn::TableLookupLanes(hn::LoadU(d, ready_.fields[f] + ready_.next), hn::IndicesFromVec(d, rank));
            *fields[f] = hn::IfThenElse(takes, next, *fields[f]);
        }
        const auto takes_int = hn::RebindMask(di, takes);
        const Int next_ray =
            hn::TableLookupLanes(hn::LoadU(di, ready_.ray + ready_.next), hn::IndicesFromVec(di, rank));
        rays.ray = hn::IfThenElse(takes_int, next_ray, rays.ray);
        rays.reads = hn::IfThenZeroElse(takes_int, rays.reads);
        ready_.next += std::min(left, hn::CountTrue(d, idle));
        steps_.Start(rays, takes);
    }

    template <class Write>
    HWY_INLINE void Retire(Rays& rays, Mask mask, Write&& write) const {
        HWY_ALIGN int ray[kLanes], reads[kLanes];
        hn::Store(rays.ray, IntTag(), ray);
        hn::Store(rays.reads, IntTag(), reads);
        for (std::uint32_t bits = Bits(mask); bits != 0; bits &= bits - 1) {
            const std::size_t l = std::size_t(__builtin_ctz(bits));
            write(l, std::size_t(ray[l]), std::uint32_t(reads[l]));
        }
        rays.ray = hn::IfThenElse(hn::RebindMask(IntTag(), mask), Whole(-1), rays.ray);
    }

    HWY_INLINE void WriteMisses(Rays& rays, Mask mask) const {
        Retire(rays, mask, [&](std::size_t, std::size_t ray, std::uint32_t reads) {
            if (results_.hits) {
                results_.hits[ray] = {};
                results_.hits[ray].reads = reads;
                return;
            }
            results_.hidden[ray] = 0;
            if (results_.reads)
                results_.reads[ray] = reads;
        });
    }

    HWY_INLINE void WriteHits(Rays& rays, Mask mask, const Found& found) const {
        if (!results_.hits) {
            Retire(rays, mask, [&](std::size_t, std::size_t ray, std::uint32_t reads) {
                results_.hidden[ray] = 1;
                if (results_.reads)
                    results_.reads[ray] = reads;
            });
            return;
        }
        const Vec width = Constant(float(field_.width)), height = Constant(float(field_.height)), half = Constant(0.5f),
                  one = Constant(1);
        const auto coordinate = [&](Vec from, Vec direction, Vec size) {
            const Vec at = hn::Div(hn::Add(hn::MulAdd(found.t, direction, from), half), size);
            if constexpr (!kRepeat)
                return at;
            const Vec rest = hn::Sub(at, hn::Floor(at)); // -1e-9 gives 1
            return hn::IfThenElseZero(hn::Lt(rest, one), rest);
        };
        const Vec values[6] = {hn::Add(rays.t_base, found.t),       coordinate(rays.x, rays.dx, width),
                               coordinate(rays.y, rays.dy, height), found.depth,
                               hn::Mul(found.slope_u, width),       hn::Mul(found.slope_v, height)};
        HWY_ALIGN float stored[6][kLanes];
        for (int k = 0; k < 6; ++k)
            hn::Store(values[k], Tag(), stored[k]);
        Retire(rays, mask, [&](std::size_t l, std::size_t ray, std::uint32_t reads) {
            results_.hits[ray] = {
                stored[0][l], {stored[1][l], stored[2][l]}, stored[3][l], {stored[4][l], stored[5][l]}, reads};
        });
    }

    static constexpr float kBelowAll = 1 + 1e-6f; ///< so that rounding does not end rays above a surface of depth 1
    static constexpr float kFarTexels = 1 << 20;

    struct Ready {
        HWY_ALIGN float fields[kFields][2 * kLanes];
        HWY_ALIGN int ray[2 * kLanes];
        std::size_t count = 0, next = 0;
    };

    const PaddedDepths& field_;
    std::span<const ReliefRay> given_;
    LaneResults results_;
    Steps steps_;
    std::size_t next_given_ = 0;
    Ready ready_;
};

} // namespace kokage::relief_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

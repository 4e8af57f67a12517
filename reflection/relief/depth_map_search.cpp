#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/relief/depth_map_search.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "reflection/relief/depth_map_search.h"
#include "reflection/relief/depth_map_tracer.h"
#include "reflection/relief/ray_lanes-inl.h"

#include <algorithm>
#include <cmath>
#include <numbers>

HWY_BEFORE_NAMESPACE();
namespace kokage::relief_lanes::HWY_NAMESPACE {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

HWY_INLINE Vec Fraction(Vec x) {
    return hn::Sub(x, hn::Floor(x));
}

/// Rays downwards through the plane, and what the map nearest to them says.
struct MapRead {
    Vec slope_u, slope_v, tangent; ///< of the ray, in units of depth_m
    Int map;
    Vec depth;
    Mask known; ///< else there is no map for the ray, and nothing was read
};

/// `u`, `v`: where the rays pass the plane; `du`, `dv`: how far they go per unit of depth; all in tiles.
template <bool kRepeat>
HWY_INLINE MapRead ReadMap(const DepthMapTable& maps, Vec u, Vec v, Vec du, Vec dv, Mask wanted) {
    const Tag d;
    const IntTag di;
    const Vec zero = hn::Zero(d), one = Constant(1);
    MapRead read;
    read.slope_u = hn::Mul(du, Constant(maps.tile_in_depths.x));
    read.slope_v = hn::Mul(dv, Constant(maps.tile_in_depths.y));
    const Vec x = hn::Abs(read.slope_u), y = hn::Abs(read.slope_v), larger = hn::Max(x, y);
    read.tangent = hn::Sqrt(hn::MulAdd(x, x, hn::Mul(y, y)));
    // Of the two zenith angles beside the ray's the one nearer to the zenith.
    const Vec ring = hn::Floor(hn::Mul(hn::Atan(d, read.tangent), Constant(float(maps.zeniths) * 2 / kPi)));
    // The azimuth within an eighth of a turn, then within the quarter, then in the turn.
    const Vec ratio = hn::IfThenElse(hn::Gt(larger, zero), hn::Div(hn::Min(x, y), larger), zero);
    Vec azimuth = hn::Atan(d, ratio);
    azimuth = hn::IfThenElse(hn::Gt(y, x), hn::Sub(Constant(kPi / 2), azimuth), azimuth);
    azimuth = hn::IfThenElse(hn::Lt(read.slope_u, zero), hn::Sub(Constant(kPi), azimuth), azimuth);
    azimuth = hn::IfThenElse(hn::Lt(read.slope_v, zero), hn::Sub(Constant(2 * kPi), azimuth), azimuth);
    const Int sectors = Whole(maps.azimuths);
    Int sector = hn::ConvertTo(di, hn::MulAdd(azimuth, Constant(float(maps.azimuths) / (2 * kPi)), Constant(0.5f)));
    sector = hn::IfThenElse(hn::Lt(sector, sectors), sector, hn::Sub(sector, sectors));
    const Int nearest = hn::ConvertTo(di, hn::Min(ring, Constant(float(maps.zeniths - 1))));

    read.known = wanted;
    if constexpr (kRepeat) {
        u = Fraction(u);
        v = Fraction(v);
    } else {
        const auto inside = [&](Vec c) { return hn::And(hn::Ge(c, zero), hn::Lt(c, one)); };
        read.known = hn::And(read.known, hn::And(inside(u), inside(v)));
    }
    const Vec size = Constant(float(maps.size)), last = Constant(float(maps.size - 1));
    const Int column = hn::ConvertTo(di, hn::Min(hn::Mul(u, size), last)),
              row = hn::ConvertTo(di, hn::Min(hn::Mul(v, size), last));
    const Int edge = Whole(maps.size), known = hn::VecFromMask(di, hn::RebindMask(di, read.known));
    read.map = hn::And(known, hn::Add(hn::Mul(nearest, sectors), sector));
    const Int texel = hn::And(known, hn::Add(hn::Mul(hn::Add(hn::Mul(read.map, edge), row), edge), column));
    // Four bytes at a multiple of four, of which one is the texel's.
    const Int three = Whole(3),
              word = hn::GatherOffset(di, reinterpret_cast<const int*>(maps.depths), hn::AndNot(three, texel));
    const hn::RebindToUnsigned<IntTag> unsigned_tag;
    const auto bits = hn::BitCast(unsigned_tag, hn::ShiftLeft<3>(hn::And(texel, three)));
    const Int byte = hn::And(hn::BitCast(di, hn::Shr(hn::BitCast(unsigned_tag, word), bits)), Whole(255));
    read.depth = hn::Mul(hn::ConvertTo(d, byte), Constant(1.f / 255));
    return read;
}

/// Eq 1: the hit P' = O + h (slope of the map's direction, 1), projected on the ray: OP = |OP'| cos θ V / |V| is, as a
/// depth, h (1 + slope' · slope) / (1 + slope²).
HWY_INLINE Vec Projected(const DepthMapTable& maps, const MapRead& read) {
    const Int place = hn::Add(read.map, read.map);
    const Vec u = hn::GatherIndex(Tag(), maps.slopes.data(), place),
              v = hn::GatherIndex(Tag(), maps.slopes.data() + 1, place), one = Constant(1);
    return hn::Div(hn::Mul(read.depth, hn::MulAdd(u, read.slope_u, hn::MulAdd(v, read.slope_v, one))),
                   hn::MulAdd(read.tangent, read.tangent, one));
}

/// Lanes look at P, then step to or fro, then bisect. A ray towards a light is searched from the light: its steps go
/// back along it, from where it leaves through the plane to just before where it starts; what lies below the surface
/// there hides the light, and no more has to be known.
template <bool kRepeat, bool kAny>
class DepthMapSteps {
  public:
    /// `start_depths`: of P, for every ray of the stream; < 0: none.
    DepthMapSteps(const PaddedDepths& field, const DepthMapSearch& search, const float* start_depths)
        : field_(field), search_(search), start_depths_(start_depths) {
        t_ = first_ = last_ = step_ = low_ = high_ = hn::Zero(Tag());
        bisected_ = phase_ = hn::Zero(Tag());
        found_ = {low_, low_, low_, low_};
    }

    HWY_INLINE void Start(Rays& rays, Mask starts) {
        const Vec zero = hn::Zero(Tag()), one = Constant(1), part = Constant(1.f / float(search_.steps));
        const Mask up = kAny ? hn::Lt(rays.ddepth, zero) : hn::Lt(zero, zero);
        const Mask slanted = hn::Or(hn::Gt(rays.ddepth, zero), up);
        const Vec per_depth = hn::Div(one, hn::IfThenElse(slanted, rays.ddepth, one)); // t; < 0 upwards
        const Vec step = hn::Mul(part, hn::IfThenElse(slanted, per_depth, rays.t_last));
        const Vec first = hn::IfThenElse(up, rays.t_last, zero);
        // What starts nearer to the plane than that is lit: its last place is before its first.
        const Vec last = hn::IfThenElse(up, hn::Mul(Constant(-search_.same_hit), per_depth), rays.t_last);
        const Int ray = hn::Max(rays.ray, Whole(0)); // -1: idle
        const Vec start = hn::GatherIndex(Tag(), start_depths_, ray);
        const Mask known = hn::And(hn::And(starts, slanted), hn::Ge(start, zero));
        rays.reads = hn::Add(rays.reads, hn::IfThenElseZero(hn::RebindMask(IntTag(), known), Whole(1)));
        Vec t = hn::Mul(hn::Sub(start, rays.depth), per_depth);
        t = hn::IfThenElse(known, Between(up, first, last, t), first);
        // At the plane nothing needs to be read: nothing is above it, and the first step is what can be inside.
        const Mask on_plane = hn::And(hn::Eq(t, first), hn::Or(up, hn::Le(rays.depth, zero)));
        const Mask at_plane = hn::And(on_plane, hn::And(slanted, hn::Ne(first, last)));
        t = hn::IfThenElse(at_plane, Between(up, first, last, hn::Add(t, step)), t);
        t_ = hn::IfThenElse(starts, t, t_);
        low_ = hn::IfThenElse(starts, first, low_);
        first_ = hn::IfThenElse(starts, first, first_);
        last_ = hn::IfThenElse(starts, last, last_);
        step_ = hn::IfThenElse(starts, step, step_);
        bisected_ = hn::IfThenZeroElse(starts, bisected_);
        phase_ = hn::IfThenElse(starts, hn::IfThenElse(at_plane, Constant(kForward), Constant(kAtP)), phase_);
    }

    HWY_INLINE Found Step(Rays& rays, Mask& hit, Mask& missed) {
        const Mask bisecting = hn::Eq(phase_, Constant(kBisect));
        const Vec t = hn::IfThenElse(bisecting, hn::Mul(Constant(0.5f), hn::Add(low_, high_)), t_);
        const Place place = PlaceOf<kRepeat>(field_, hn::MulAdd(t, rays.dx, rays.x), hn::MulAdd(t, rays.dy, rays.y));
        const Cells cells = CellsAt(field_, place);
        const Vec depth = cells.depth(place.a, place.b);
        const Mask below = hn::Ge(hn::MulAdd(t, rays.ddepth, rays.depth), depth);
        if constexpr (kAny) {
            const Mask up = hn::Lt(step_, hn::Zero(Tag())), none = hn::And(up, hn::Gt(last_, first_));
            rays.reads = hn::Add(rays.reads, hn::IfThenZeroElse(hn::RebindMask(IntTag(), none), Whole(1)));
            hit = hn::AndNot(none, below);
            missed = hn::Or(none, hn::AndNot(below, hn::Eq(t, last_)));
            t_ = Between(up, first_, last_, hn::Add(t_, step_));
            return found_;
        }
        rays.reads = hn::Add(rays.reads, Whole(1));
        found_.t = high_ = hn::IfThenElse(below, t, high_);
        found_.depth = hn::IfThenElse(below, depth, found_.depth);
        found_.slope_u = hn::IfThenElse(below, cells.slope_a(place.b), found_.slope_u);
        found_.slope_v = hn::IfThenElse(below, cells.slope_b(place.a), found_.slope_v);
        low_ = hn::IfThenElse(below, low_, t);

        const Mask at_p = hn::Eq(phase_, Constant(kAtP)), forward = hn::Eq(phase_, Constant(kForward)),
                   backward = hn::Eq(phase_, Constant(kBackward));
        const Mask goes_on = hn::AndNot(below, hn::Or(at_p, forward)),
                   goes_back = hn::And(below, hn::Or(at_p, backward));
        missed = hn::And(goes_on, hn::Ge(t, last_));
        hit = hn::And(goes_back, hn::Le(t, first_)); // the ray begins in the relief
        const Mask crossed = hn::Or(hn::And(forward, below), hn::AndNot(below, backward));
        bisected_ = hn::IfThenElse(bisecting, hn::Add(bisected_, Constant(1)), bisected_);
        hit = hn::Or(hit, hn::And(hn::Or(crossed, bisecting), hn::Ge(bisected_, Constant(float(search_.bisections)))));
        phase_ = hn::IfThenElse(goes_on, Constant(kForward), phase_);
        phase_ = hn::IfThenElse(goes_back, Constant(kBackward), phase_);
        phase_ = hn::IfThenElse(crossed, Constant(kBisect), phase_);
        const Vec next = hn::Add(t_, hn::IfThenElse(goes_back, hn::Neg(step_), step_));
        t_ = hn::Max(first_, hn::Min(next, last_));
        return found_;
    }

  private:
    static constexpr float kAtP = 0, kForward = 1, kBackward = 2, kBisect = 3;

    /// `first` and `last` are the other way round for rays upwards.
    HWY_INLINE static Vec Between(Mask up, Vec first, Vec last, Vec t) {
        const Vec low = hn::IfThenElse(up, last, first), high = hn::IfThenElse(up, first, last);
        return hn::Max(low, hn::Min(t, high));
    }

    const PaddedDepths& field_;
    const DepthMapSearch& search_;
    const float* start_depths_;
    Vec first_, last_, step_; ///< t: where the search may begin and end, and forward
    Vec t_, phase_;           ///< of the next read
    Vec low_, high_;          ///< t of the last points above the surface and below
    Vec bisected_;
    Found found_;
};

/// For every ray the depth that its map gives, projected by eq 1 (kProject) or as it stands; -1 where there is none:
/// for rays that do not slant downwards (or, with kUpwards, upwards).
template <bool kRepeat, bool kUpwards, bool kProject>
void ReadMaps(const DepthMapTable& maps, std::span<const ReliefRay> rays, float* depths) {
    const Tag d;
    const float steepest = kProject ? 1e9f : std::tan(float(kLastBoundedZenith) * kPi / 180);
    std::array<ReliefRay, kLanes> few;
    for (std::size_t first = 0; first < rays.size(); first += kLanes) {
        const std::size_t count = std::min(kLanes, rays.size() - first);
        const ReliefRay* from = rays.data() + first;
        if (count < kLanes)
            from = (std::copy_n(from, count, few.begin()), few.data());
        const auto field = [&](int k) {
            return hn::GatherIndex(d, reinterpret_cast<const float*>(from) + k,
                                   hn::Mul(hn::Iota(IntTag(), 0), Whole(7)));
        };
        const Vec z = field(2), dz = field(5), one = Constant(1), speed = kUpwards ? hn::Abs(dz) : dz;
        const Mask slanted = hn::And(hn::Gt(speed, Constant(1e-9f)), hn::Lt(speed, Constant(1e9f)));
        const Vec per_depth = hn::Div(one, hn::IfThenElse(slanted, dz, one)), du = hn::Mul(field(3), per_depth),
                  dv = hn::Mul(field(4), per_depth);
        Vec u = field(0), v = field(1);
        if constexpr (kRepeat) {
            u = Fraction(u);
            v = Fraction(v);
        }
        // Whoever comes from further away would not find its texel in single precision.
        const Vec travel = hn::Mul(hn::Abs(z), hn::Max(hn::Abs(du), hn::Abs(dv)));
        const MapRead read = ReadMap<kRepeat>(maps, hn::NegMulAdd(z, du, u), hn::NegMulAdd(z, dv, v), du, dv,
                                              hn::And(slanted, hn::Lt(travel, Constant(kProject ? 1e4f : 16.f))));
        const Mask known = hn::And(read.known, hn::Lt(read.tangent, Constant(steepest)));
        HWY_ALIGN float stored[kLanes];
        hn::Store(hn::IfThenElse(known, kProject ? Projected(maps, read) : read.depth, Constant(-1)), d, stored);
        std::copy_n(stored, count, depths + first);
    }
}

template <bool kRepeat>
void Run(const PaddedDepths& field, const DepthMapTable& maps, const DepthMapSearch& search,
         std::span<const ReliefRay> rays, const LaneResults& results) {
    std::vector<float> starts(rays.size());
    if (results.hits) {
        ReadMaps<kRepeat, false, true>(maps, rays, starts.data());
        RayStream<kRepeat, DepthMapSteps<kRepeat, false>>(field, rays, results, {field, search, starts.data()}).run();
    } else {
        ReadMaps<kRepeat, true, true>(maps, rays, starts.data());
        RayStream<kRepeat, DepthMapSteps<kRepeat, true>>(field, rays, results, {field, search, starts.data()}).run();
    }
}

} // namespace

void SearchDepthMaps(const PaddedDepths& field, const DepthMapTable& maps, const DepthMapSearch& search,
                     std::span<const ReliefRay> rays, const LaneResults& results) {
    if (field.wrap == HeightWrap::repeat)
        Run<true>(field, maps, search, rays, results);
    else
        Run<false>(field, maps, search, rays, results);
}

void ReadBounds(const DepthMapTable& maps, HeightWrap wrap, std::span<const ReliefRay> rays, float* bounds) {
    if (wrap == HeightWrap::repeat)
        ReadMaps<true, false, false>(maps, rays, bounds);
    else
        ReadMaps<false, false, false>(maps, rays, bounds);
}

} // namespace kokage::relief_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {
namespace relief_lanes {

HWY_EXPORT(SearchDepthMaps);
HWY_EXPORT(ReadBounds);

} // namespace relief_lanes

DepthMapTable::DepthMapTable(const DepthMaps& maps)
    : depths(maps.depths()), azimuths(maps.settings().azimuths), zeniths(maps.settings().zeniths),
      size(maps.settings().size), tile_in_depths(maps.settings().scale.tile_m / maps.settings().scale.depth_m) {
    for (int map = 0; map < maps.settings().maps(); ++map) {
        const glm::dvec2 slope = sampling_slope(maps.settings(), map);
        slopes.push_back(float(slope.x));
        slopes.push_back(float(slope.y));
    }
}

void search_depth_maps(const PaddedDepths& field, const DepthMapTable& maps, const DepthMapSearch& search,
                       std::span<const ReliefRay> rays, const LaneResults& results) {
    using namespace relief_lanes;
    HWY_DYNAMIC_DISPATCH(SearchDepthMaps)(field, maps, search, rays, results);
}

void read_bounds(const DepthMapTable& maps, HeightWrap wrap, std::span<const ReliefRay> rays, float* bounds) {
    using namespace relief_lanes;
    HWY_DYNAMIC_DISPATCH(ReadBounds)(maps, wrap, rays, bounds);
}

} // namespace kokage
#endif

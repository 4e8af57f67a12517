// Rays on their way out of lanes (exact_lanes-inl.h): hits, misses, doubts. Per-target code of Google Highway: included
// once for every instruction set, so the guard toggles.
#include "reflection/relief/bound_planes.h"
#include "reflection/relief/exact_lanes-inl.h"
#include "reflection/relief/exact_stream.h"

#include <vector>

#include <hwy/highway.h>

#if defined(KOKAGE_EXACT_RESULTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef KOKAGE_EXACT_RESULTS_INL_H
#undef KOKAGE_EXACT_RESULTS_INL_H
#else
#define KOKAGE_EXACT_RESULTS_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::exact_lanes::HWY_NAMESPACE {

/// Where the rays of a stream leave what became of them; they leave their lanes with it. kAny: only whether they are
/// hidden.
template <bool kRepeat, bool kAny>
class RayResults {
  public:
    RayResults(const BoundPlanes& bounds, ReliefHit* hits, std::uint8_t* hidden, std::uint32_t* reads,
               std::vector<DoubtfulRay>& doubtful)
        : width_(float(bounds.width)), height_(float(bounds.height)), hits_(hits), hidden_(hidden), reads_(reads),
          doubtful_(doubtful) {}

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
    /// Of a ray that single precision is not fit for.
    HWY_INLINE void WriteUnfit(std::size_t ray) {
        WriteMiss(ray, 0);
        doubtful_.push_back({ray, 0});
    }
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
        const Vec width = Constant(width_), height = Constant(height_);
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

  private:
    HWY_INLINE static void Retire(Lanes& g, Mask mask) {
        g.level = hn::IfThenElse(hn::RebindMask(IntTag(), mask), Whole(-1), g.level);
    }
    /// rays() and reads() of lanes in memory.
    struct Names {
        HWY_ALIGN int ray[kLanes], reads[kLanes];
        HWY_INLINE explicit Names(const Lanes& g) {
            hn::Store(g.ray, IntTag(), ray);
            hn::Store(g.reads, IntTag(), reads);
        }
    };

    float width_, height_;
    ReliefHit* hits_;
    std::uint8_t* hidden_;
    std::uint32_t* reads_;
    std::vector<DoubtfulRay>& doubtful_;
};
} // namespace kokage::exact_lanes::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/maps/lobe_sums.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "reflection/maps/lobe_sums.h"

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;

/// (1-w)^shape: lobes.h's phong_lobe_value over its peak; w = half the squared distance.
struct PhongShape {
    static HWY_INLINE Vec value(Tag d, Vec shape, Vec w) {
        const auto in_front = hn::Lt(w, hn::Set(d, 1.f));
        const Vec power = hn::Mul(shape, hn::Log1p(d, hn::Neg(hn::IfThenElseZero(in_front, w))));
        return hn::IfThenElseZero(in_front, hn::Exp(d, power));
    }
};

/// (1-w)/(1+shape w)^2: ggx_lobe_value over its peak.
struct GgxShape {
    static HWY_INLINE Vec value(Tag d, Vec shape, Vec w) {
        const Vec one = hn::Set(d, 1.f), fall = hn::MulAdd(shape, w, one);
        return hn::Div(hn::Max(hn::Sub(one, w), hn::Zero(d)), hn::Mul(fall, fall));
    }
};

template <class Shape>
HWY_INLINE void sum(const LobeArrays& texels, std::span<const PointOfLight> points, float* sums, std::size_t stride) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const Vec half = hn::Set(d, 0.5f);
    for (std::size_t i = 0; i < texels.count; i += lanes) {
        const Vec x = hn::LoadU(d, texels.x + i), y = hn::LoadU(d, texels.y + i), z = hn::LoadU(d, texels.z + i),
                  shape = hn::LoadU(d, texels.shape + i);
        Vec red = hn::Zero(d), green = hn::Zero(d), blue = hn::Zero(d);
        for (const PointOfLight& point : points) {
            const Vec dx = hn::Sub(x, hn::Set(d, point.direction.x)), dy = hn::Sub(y, hn::Set(d, point.direction.y)),
                      dz = hn::Sub(z, hn::Set(d, point.direction.z));
            const Vec w = hn::Mul(half, hn::MulAdd(dx, dx, hn::MulAdd(dy, dy, hn::Mul(dz, dz))));
            const Vec value = Shape::value(d, shape, w);
            red = hn::MulAdd(value, hn::Set(d, point.irradiance.r), red);
            green = hn::MulAdd(value, hn::Set(d, point.irradiance.g), green);
            blue = hn::MulAdd(value, hn::Set(d, point.irradiance.b), blue);
        }
        const Vec peak = hn::LoadU(d, texels.peak + i);
        hn::StoreU(hn::Mul(peak, red), d, sums + i);
        hn::StoreU(hn::Mul(peak, green), d, sums + stride + i);
        hn::StoreU(hn::Mul(peak, blue), d, sums + 2 * stride + i);
    }
}

} // namespace

void SumLobes(LobeKind kind, const LobeArrays& texels, std::span<const PointOfLight> points, float* sums,
              std::size_t stride) {
    if (kind == LobeKind::phong)
        sum<PhongShape>(texels, points, sums, stride);
    else
        sum<GgxShape>(texels, points, sums, stride);
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(SumLobes);

void sum_lobes(LobeKind kind, const LobeArrays& texels, std::span<const PointOfLight> points, float* sums,
               std::size_t stride) {
    HWY_DYNAMIC_DISPATCH(SumLobes)(kind, texels, points, sums, stride);
}

} // namespace kokage
#endif

// ShellMap's lookup of many directions. The scalar lookup in shell_map.cpp is its twin.
#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/maps/shell_lookup.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "reflection/maps/shell_lookup.h"

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using FloatTag = hn::ScalableTag<float>;
using IntTag = hn::RebindToSigned<FloatTag>;
using Vec = hn::Vec<FloatTag>;
using Ints = hn::Vec<IntTag>;

struct Colour {
    Vec r, g, b;
};

/// face_place() of face_chart.h.
struct Places {
    Ints face;
    Vec u, v;
};
HWY_INLINE Places FacePlaces(FloatTag d, Vec x, Vec y, Vec z) {
    const IntTag di;
    const Vec zero = hn::Zero(d), ax = hn::Abs(x), ay = hn::Abs(y), az = hn::Abs(z);
    const auto is_x = hn::And(hn::Ge(ax, ay), hn::Ge(ax, az)), is_y = hn::AndNot(is_x, hn::Ge(ay, az));
    const auto pick = [&](Vec of_x, Vec of_y, Vec of_z) {
        return hn::IfThenElse(is_x, of_x, hn::IfThenElse(is_y, of_y, of_z));
    };
    const auto negative = hn::Lt(pick(x, y, z), zero);
    const Vec major = pick(ax, ay, az);
    const auto flipped_if = [&](auto mask, Vec value) { return hn::IfThenElse(mask, hn::Neg(value), value); };
    const Vec u = pick(flipped_if(hn::Not(negative), z), x, flipped_if(negative, x));
    const Vec v = hn::IfThenElse(is_y, flipped_if(negative, z), hn::Neg(y));
    const Vec scale = hn::Set(d, 4 / kPi);
    const Ints face = hn::ConvertTo(di, pick(zero, hn::Set(d, 2), hn::Set(d, 4)));
    const Ints minus = hn::VecFromMask(di, hn::RebindMask(di, negative)); // -1 where negative
    return {hn::Sub(face, minus), hn::Mul(scale, hn::Atan(d, hn::Div(u, major))),
            hn::Mul(scale, hn::Atan(d, hn::Div(v, major)))};
}

/// IEEE halves in the low 16 bits: shifted to a float's place, exponents corrected by a product (subnormals too).
HWY_INLINE Vec FromHalf(FloatTag d, Ints half) {
    const IntTag di;
    const Ints magnitude = hn::ShiftLeft<13>(hn::And(half, hn::Set(di, 0x7fff)));
    const Ints sign = hn::ShiftLeft<16>(hn::And(half, hn::Set(di, 0x8000)));
    const Vec value = hn::Mul(hn::BitCast(d, magnitude), hn::Set(d, 0x1p112f));
    return hn::BitCast(d, hn::Or(hn::BitCast(di, value), sign));
}

template <TexelFormat Format>
HWY_INLINE Colour Texel(FloatTag d, const std::byte* texels, Ints index) {
    const IntTag di;
    const Ints three = hn::Add(index, hn::Add(index, index));
    if constexpr (Format == TexelFormat::float_rgb) {
        const auto* channels = reinterpret_cast<const float*>(texels);
        return {hn::GatherIndex(d, channels, three), hn::GatherIndex(d, channels + 1, three),
                hn::GatherIndex(d, channels + 2, three)};
    } else if constexpr (Format == TexelFormat::half_rgb) {
        // Two words of 32 bits hold the three halves; an odd texel begins in the middle of the first.
        const auto* words = reinterpret_cast<const std::int32_t*>(texels);
        const Ints word = hn::ShiftRight<1>(three);
        const Ints first = hn::GatherIndex(di, words, word), second = hn::GatherIndex(di, words + 1, word);
        const auto odd = hn::Eq(hn::And(index, hn::Set(di, 1)), hn::Set(di, 1));
        const Ints first_high = hn::ShiftRight<16>(first), second_high = hn::ShiftRight<16>(second);
        return {FromHalf(d, hn::IfThenElse(odd, first_high, first)),
                FromHalf(d, hn::IfThenElse(odd, second, first_high)),
                FromHalf(d, hn::IfThenElse(odd, second_high, second))};
    } else {
        const Ints code = hn::GatherIndex(di, reinterpret_cast<const std::int32_t*>(texels), index);
        const Ints nine = hn::Set(di, 511), exponent = hn::And(hn::ShiftRight<27>(code), hn::Set(di, 31));
        const Vec step = hn::BitCast(d, hn::ShiftLeft<23>(hn::Add(exponent, hn::Set(di, 127 - 24))));
        const auto channel = [&](Ints bits) { return hn::Mul(step, hn::ConvertTo(d, hn::And(bits, nine))); };
        return {channel(code), channel(hn::ShiftRight<9>(code)), channel(hn::ShiftRight<18>(code))};
    }
}

template <TexelFilter Filter>
struct Weights {
    static constexpr int count = Filter == TexelFilter::cubic ? 4 : 2;
    Vec weight[count];
    HWY_INLINE Weights(FloatTag d, Vec f) {
        const Vec g = hn::Sub(hn::Set(d, 1), f);
        if constexpr (Filter == TexelFilter::bilinear) {
            weight[0] = g;
            weight[1] = f;
        } else { // uniform cubic B-spline
            const Vec sixth = hn::Set(d, 1.f / 6), two_thirds = hn::Set(d, 4.f / 6);
            const auto cubed = [&](Vec t) { return hn::Mul(hn::Mul(sixth, t), hn::Mul(t, t)); };
            const auto middle = [&](Vec t) {
                return hn::MulAdd(hn::Mul(t, t), hn::MulAdd(hn::Set(d, 0.5f), t, hn::Set(d, -1)), two_thirds);
            };
            weight[0] = cubed(g);
            weight[1] = middle(f);
            weight[2] = middle(g);
            weight[3] = cubed(f);
        }
    }
};

/// One shell for each lane; adds share x its value.
template <TexelFormat Format, TexelFilter Filter>
HWY_INLINE void AddShells(FloatTag d, const ShellTable& table, Ints shell, const Places& places, Vec share,
                          Colour& sum) {
    const IntTag di;
    const Ints resolution = hn::GatherIndex(di, table.resolution.data(), shell);
    const Ints first = hn::GatherIndex(di, table.first.data(), shell);
    const Vec half = hn::Mul(hn::Set(d, 0.5f), hn::ConvertTo(d, hn::Sub(resolution, hn::Set(di, 1))));
    const Ints last = hn::Sub(resolution, hn::Set(di, 2)), zero = hn::Zero(di);
    const Vec x = hn::MulAdd(half, places.u, half), y = hn::MulAdd(half, places.v, half);
    const Ints column = hn::Min(hn::Max(hn::ConvertTo(di, x), zero), last);
    const Ints row = hn::Min(hn::Max(hn::ConvertTo(di, y), zero), last);
    const Weights<Filter> along_u(d, hn::Sub(x, hn::ConvertTo(d, column)));
    const Weights<Filter> along_v(d, hn::Sub(y, hn::ConvertTo(d, row)));
    const Ints edge = hn::Add(resolution, hn::Set(di, Filter == TexelFilter::cubic ? 2 : 0));
    Ints line = hn::Add(first, hn::Add(hn::Mul(hn::Add(hn::Mul(places.face, edge), row), edge), column));
    for (int j = 0; j < Weights<Filter>::count; ++j) {
        const Vec row_share = hn::Mul(share, along_v.weight[j]);
        for (int i = 0; i < Weights<Filter>::count; ++i) {
            const Colour texel = Texel<Format>(d, table.texels, hn::Add(line, hn::Set(di, i)));
            const Vec weight = hn::Mul(row_share, along_u.weight[i]);
            sum.r = hn::MulAdd(weight, texel.r, sum.r);
            sum.g = hn::MulAdd(weight, texel.g, sum.g);
            sum.b = hn::MulAdd(weight, texel.b, sum.b);
        }
        line = hn::Add(line, edge);
    }
}

template <TexelFormat Format, TexelFilter Filter>
void LookUp(const ShellTable& table, const float* directions, const float* parameters, float* filtered,
            std::size_t count) {
    const FloatTag d;
    const IntTag di;
    const std::size_t lanes = hn::Lanes(d);
    const Vec zero = hn::Zero(d), one = hn::Set(d, 1);
    for (std::size_t k = 0; k + lanes <= count; k += lanes) {
        Vec x, y, z;
        hn::LoadInterleaved3(d, directions + 3 * k, x, y, z);
        const Places places = FacePlaces(d, x, y, z);
        const Vec parameter = hn::LoadU(d, parameters + k);
        Vec width = table.kind == LobeKind::phong ? hn::Div(one, hn::Sqrt(hn::Add(parameter, one)))
                                                  : hn::Mul(parameter, parameter);
        width = hn::Min(hn::Max(width, hn::Set(d, table.least_width)), hn::Set(d, table.most_width));
        const Vec power = hn::Exp(d, hn::Mul(hn::Set(d, ShellMap::spacing_power), hn::Log(d, width)));
        const Vec position = hn::Mul(hn::Sub(hn::Set(d, table.first_power), power), hn::Set(d, table.shells_a_power));
        const Ints index =
            hn::Min(hn::Max(hn::ConvertTo(di, position), hn::Zero(di)), hn::Set(di, table.last_interval));
        const Ints next = hn::Min(hn::Add(index, hn::Set(di, 1)), hn::Set(di, table.last_shell));
        const Vec a = hn::GatherIndex(d, table.width.data(), index), b = hn::GatherIndex(d, table.width.data(), next);
        const Vec span = hn::Max(hn::Sub(a, b), hn::Set(d, 1e-30f)); // one shell alone: share 0
        const Vec share = hn::Min(hn::Max(hn::Div(hn::Sub(a, width), span), zero), one);
        Colour sum{zero, zero, zero};
        AddShells<Format, Filter>(d, table, index, places, hn::Sub(one, share), sum);
        AddShells<Format, Filter>(d, table, next, places, share, sum);
        hn::StoreInterleaved3(hn::Max(sum.r, zero), hn::Max(sum.g, zero), hn::Max(sum.b, zero), d, filtered + 3 * k);
    }
}

std::size_t Lanes() {
    return hn::Lanes(FloatTag());
}

template <TexelFormat Format>
void LookUpAs(const ShellTable& table, const float* directions, const float* parameters, float* filtered,
              std::size_t count) {
    if (table.filter == TexelFilter::cubic)
        LookUp<Format, TexelFilter::cubic>(table, directions, parameters, filtered, count);
    else
        LookUp<Format, TexelFilter::bilinear>(table, directions, parameters, filtered, count);
}

void LookUpAll(const ShellTable& table, const float* directions, const float* parameters, float* filtered,
               std::size_t count) {
    if (table.format == TexelFormat::half_rgb)
        LookUpAs<TexelFormat::half_rgb>(table, directions, parameters, filtered, count);
    else if (table.format == TexelFormat::float_rgb)
        LookUpAs<TexelFormat::float_rgb>(table, directions, parameters, filtered, count);
    else
        LookUpAs<TexelFormat::shared_exponent>(table, directions, parameters, filtered, count);
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(LookUpAll);
HWY_EXPORT(Lanes);

std::size_t shell_lookup_lanes() {
    return HWY_DYNAMIC_DISPATCH(Lanes)();
}

void look_up_shells(const ShellTable& table, const float* directions, const float* parameters, float* filtered,
                    std::size_t count) {
    HWY_DYNAMIC_DISPATCH(LookUpAll)(table, directions, parameters, filtered, count);
}

} // namespace kokage
#endif

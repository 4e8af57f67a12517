#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/maps/lat_long_sums.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "common/directions/lobes.h"
#include "common/environment/lat_long.h"
#include "reflection/maps/lat_long_sums.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Doubles = hn::ScalableTag<double>;
using Floats = hn::Rebind<float, Doubles>;
using Vec = hn::Vec<Doubles>;

/// (1-w)^exponent relative to its value at w_nearest.
struct PhongWeight {
    double exponent, log_nearest;
    HWY_INLINE Vec operator()(Doubles d, Vec w) const {
        const Vec one = hn::Set(d, 1.0);
        const auto in_front = hn::Lt(w, one);
        const Vec log_cosine = hn::Log1p(d, hn::Neg(hn::IfThenElseZero(in_front, w)));
        const Vec power = hn::MulAdd(hn::Set(d, exponent), log_cosine, hn::Set(d, -log_nearest));
        return hn::IfThenElseZero(in_front, hn::Exp(d, power));
    }
};

/// (1-w)/(1+xw)² relative to its value at w_nearest.
struct GgxWeight {
    double falloff, scale;
    HWY_INLINE Vec operator()(Doubles d, Vec w) const {
        const Vec one = hn::Set(d, 1.0);
        const Vec fall = hn::MulAdd(hn::Set(d, falloff), w, one);
        return hn::Div(hn::Max(hn::Mul(hn::Set(d, scale), hn::Sub(one, w)), hn::Zero(d)), hn::Mul(fall, fall));
    }
};

struct Accumulator {
    Vec weight, sums[3];
};

struct NoHorizon {};

/// The share of pixels above a horizon: a pixel is a parallelogram, which the plane cuts straight.
struct Horizon {
    const LatLongPlanes& planes;
    const glm::dvec3& normal;
    HWY_INLINE Vec Share(Doubles d, std::size_t row, Vec column_x, Vec column_z) const {
        const double sine = planes.row_sine[row], cosine = planes.row_cosine[row];
        const Vec x = hn::Set(d, normal.x), z = hn::Set(d, normal.z);
        const Vec radial = hn::MulAdd(x, column_x, hn::Mul(z, column_z)); // n along the row's meridian
        const Vec around = hn::MulSub(z, column_x, hn::Mul(x, column_z)); // and along the row
        const Vec height = hn::MulAdd(hn::Set(d, sine), radial, hn::Set(d, normal.y * cosine));
        const Vec down = hn::MulAdd(hn::Set(d, cosine), radial, hn::Set(d, -normal.y * sine));
        // The corners' heights are height +- a +- b; heights between them are spread as a trapezoid, whose share above
        // 0 is the second integral of four steps, ramps squared.
        const Vec a = hn::Abs(hn::Mul(down, hn::Set(d, 0.5 * kPiDouble / planes.height)));
        const Vec b = hn::Abs(hn::Mul(around, hn::Set(d, kPiDouble * sine / planes.width)));
        const Vec wide = hn::Max(hn::Max(a, b), hn::Set(d, 1e-300));
        // Not narrower than this, so that the corners' differences keep their digits.
        const Vec narrow = hn::Max(hn::Min(a, b), hn::Mul(wide, hn::Set(d, 1e-6)));
        const auto ramp_squared = [&](Vec v) {
            const Vec r = hn::Max(v, hn::Zero(d));
            return hn::Mul(r, r);
        };
        const Vec sum = hn::Add(wide, narrow), difference = hn::Sub(wide, narrow);
        const Vec corners =
            hn::Add(hn::Sub(hn::Sub(ramp_squared(hn::Add(height, sum)), ramp_squared(hn::Add(height, difference))),
                            ramp_squared(hn::Sub(height, difference))),
                    ramp_squared(hn::Sub(height, sum)));
        const Vec share = hn::Div(corners, hn::Mul(hn::Set(d, 8.0), hn::Mul(wide, narrow)));
        const Vec clear = hn::IfThenElseZero(hn::Gt(height, hn::Zero(d)), hn::Set(d, 1.0));
        return hn::IfThenElse(hn::Ge(hn::Abs(height), sum), clear,
                              hn::Min(hn::Max(share, hn::Zero(d)), hn::Set(d, 1.0)));
    }
};

/// Adds pixels [begin, end) of a row.
template <class Weight, class Above>
HWY_INLINE void AddSpan(const LatLongPlanes& planes, std::size_t row, std::size_t begin, std::size_t end,
                        const Weight& weight_of, const Above& above, const glm::dvec3& direction, Accumulator& all) {
    const Doubles d;
    const Floats f;
    const Vec sine = hn::Set(d, planes.row_sine[row]), x = hn::Set(d, direction.x), z = hn::Set(d, direction.z);
    const double down = planes.row_cosine[row] - direction.y;
    const Vec down_squared = hn::Set(d, down * down), half = hn::Set(d, 0.5), angle = hn::Set(d, planes.row_angle[row]);
    for (std::size_t column = begin; column < end; column += hn::Lanes(d)) {
        const Vec column_x = hn::LoadU(d, planes.column_x.data() + column);
        const Vec column_z = hn::LoadU(d, planes.column_z.data() + column);
        const Vec dx = hn::MulSub(sine, column_x, x), dz = hn::MulSub(sine, column_z, z);
        const Vec squared = hn::MulAdd(dx, dx, hn::MulAdd(dz, dz, down_squared));
        Vec weight = hn::Mul(angle, weight_of(d, hn::Mul(half, squared)));
        if (HWY_UNLIKELY(end - column < hn::Lanes(d)))
            weight = hn::IfThenElseZero(hn::FirstN(d, end - column), weight);
        all.weight = hn::Add(all.weight, weight);
        if constexpr (std::is_same_v<Above, Horizon>)
            weight = hn::Mul(weight, above.Share(d, row, column_x, column_z));
        const std::size_t at = row * planes.stride + column;
        for (int c = 0; c < 3; ++c)
            all.sums[c] = hn::MulAdd(weight, hn::PromoteTo(d, hn::LoadU(f, planes.planes[c].data() + at)), all.sums[c]);
    }
}

template <class Weight, class Above>
LobeSums SumRows(const LatLongPlanes& planes, const glm::dvec3& direction, double reach, const Weight& weight_of,
                 const Above& above) {
    const Doubles d;
    Accumulator all{hn::Zero(d), {hn::Zero(d), hn::Zero(d), hn::Zero(d)}};
    const double reach_angle = 2 * std::asin(std::sqrt(std::clamp(0.25 * reach, 0.0, 1.0))) + 1e-7;
    const double theta = std::acos(std::clamp(direction.y, -1.0, 1.0)), least_cosine = 1 - 0.5 * reach;
    const double across = std::hypot(direction.x, direction.z), middle = std::atan2(direction.z, direction.x);
    const int width = planes.width;
    for (int row = 0; row < planes.height; ++row) {
        const std::size_t r = std::size_t(row);
        if (std::abs(planes.row_theta[r] - theta) > reach_angle)
            continue;
        // In the row, cos = A + B cos(azimuth - middle).
        const double a = planes.row_cosine[r] * direction.y, b = planes.row_sine[r] * across;
        const double half_span = b > 0 ? std::acos(std::clamp((least_cosine - a) / b, -1.0, 1.0)) : kPiDouble;
        const double per_radian = width / (2 * kPiDouble), centre = (middle + kPiDouble) * per_radian;
        const int first = int(std::floor(centre - half_span * per_radian)) - 1;
        const int last = int(std::ceil(centre + half_span * per_radian)) + 1;
        if (last - first >= width) {
            AddSpan(planes, r, 0, std::size_t(width), weight_of, above, direction, all);
            continue;
        }
        const int begin = ((first % width) + width) % width, end = begin + last - first;
        AddSpan(planes, r, std::size_t(begin), std::size_t(std::min(end, width)), weight_of, above, direction, all);
        if (end > width)
            AddSpan(planes, r, 0, std::size_t(end - width), weight_of, above, direction, all);
    }
    LobeSums sums;
    sums.weight = hn::GetLane(hn::SumOfLanes(d, all.weight));
    for (int c = 0; c < 3; ++c)
        sums.radiance[c] = hn::GetLane(hn::SumOfLanes(d, all.sums[c]));
    return sums;
}

template <class Above>
LobeSums SumAbove(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction, double reach,
                  double nearest, const Above& above) {
    const double w = 0.5 * nearest;
    if (lobe.kind == LobeKind::phong)
        return SumRows(planes, direction, reach,
                       PhongWeight{lobe.parameter, w > 0 ? lobe.parameter * std::log1p(-w) : 0}, above);
    const double x = ggx_falloff(lobe.parameter), fall = 1 + x * w;
    return SumRows(planes, direction, reach, GgxWeight{x, fall * fall / (1 - w)}, above);
}

LobeSums SumOverLobe(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction, double reach,
                     double nearest, const glm::dvec3* horizon) {
    return horizon ? SumAbove(planes, lobe, direction, reach, nearest, Horizon{planes, *horizon})
                   : SumAbove(planes, lobe, direction, reach, nearest, NoHorizon{});
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(SumOverLobe);

LobeSums sum_over_lobe(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction, double reach,
                       double nearest, const glm::dvec3* horizon) {
    return HWY_DYNAMIC_DISPATCH(SumOverLobe)(planes, lobe, direction, reach, nearest, horizon);
}

LatLongPlanes::LatLongPlanes(int image_width, int image_height) : width(image_width), height(image_height) {
    constexpr std::size_t padding = 256; // doubles in the longest vector that any instruction set has
    stride = std::size_t(width);
    for (int y = 0; y < height; ++y) {
        const double theta = kPiDouble * (y + 0.5) / height;
        row_theta.push_back(theta);
        row_sine.push_back(std::sin(theta));
        row_cosine.push_back(std::cos(theta));
        row_angle.push_back(pixel_solid_angle(y, width, height));
    }
    column_x.resize(stride + padding);
    column_z.resize(stride + padding);
    for (std::size_t x = 0; x < stride; ++x) {
        const double phi = 2 * kPiDouble * ((double(x) + 0.5) / width - 0.5);
        column_x[x] = std::cos(phi);
        column_z[x] = std::sin(phi);
    }
    for (std::vector<float>& plane : planes)
        plane.resize(stride * std::size_t(height) + padding);
}

void LatLongPlanes::set_pixels(const Image& image, float scale) {
    for (std::size_t i = 0; i < stride * std::size_t(height); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            planes[c][i] = scale * image.pixels[i * std::size_t(image.channels) + c];
}

glm::dvec3 LatLongPlanes::direction(int x, int y) const {
    const std::size_t column = std::size_t(x), row = std::size_t(y);
    return {row_sine[row] * column_x[column], row_cosine[row], row_sine[row] * column_z[column]};
}

glm::dvec3 LatLongPlanes::pixel(int x, int y) const {
    const std::size_t at = std::size_t(y) * stride + std::size_t(x);
    return {planes[0][at], planes[1][at], planes[2][at]};
}

} // namespace kokage
#endif

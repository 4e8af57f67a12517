// Vector code by Google Highway: compiled once for every instruction set, chosen at run time.
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

/// Adds pixels [begin, end) of a row.
template <class Weight>
HWY_INLINE void AddSpan(const LatLongPlanes& planes, std::size_t row, std::size_t begin, std::size_t end,
                        const Weight& weight_of, const glm::dvec3& direction, Accumulator& all) {
    const Doubles d;
    const Floats f;
    const Vec sine = hn::Set(d, planes.row_sine[row]), x = hn::Set(d, direction.x), z = hn::Set(d, direction.z);
    const double down = planes.row_cosine[row] - direction.y;
    const Vec down_squared = hn::Set(d, down * down), half = hn::Set(d, 0.5), angle = hn::Set(d, planes.row_angle[row]);
    for (std::size_t column = begin; column < end; column += hn::Lanes(d)) {
        const Vec dx = hn::MulSub(sine, hn::LoadU(d, planes.column_x.data() + column), x);
        const Vec dz = hn::MulSub(sine, hn::LoadU(d, planes.column_z.data() + column), z);
        const Vec squared = hn::MulAdd(dx, dx, hn::MulAdd(dz, dz, down_squared));
        Vec weight = hn::Mul(angle, weight_of(d, hn::Mul(half, squared)));
        if (HWY_UNLIKELY(end - column < hn::Lanes(d)))
            weight = hn::IfThenElseZero(hn::FirstN(d, end - column), weight);
        all.weight = hn::Add(all.weight, weight);
        const std::size_t at = row * planes.stride + column;
        for (int c = 0; c < 3; ++c)
            all.sums[c] = hn::MulAdd(weight, hn::PromoteTo(d, hn::LoadU(f, planes.planes[c].data() + at)), all.sums[c]);
    }
}

template <class Weight>
LobeSums SumRows(const LatLongPlanes& planes, const glm::dvec3& direction, double reach, const Weight& weight_of) {
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
            AddSpan(planes, r, 0, std::size_t(width), weight_of, direction, all);
            continue;
        }
        const int begin = ((first % width) + width) % width, end = begin + last - first;
        AddSpan(planes, r, std::size_t(begin), std::size_t(std::min(end, width)), weight_of, direction, all);
        if (end > width)
            AddSpan(planes, r, 0, std::size_t(end - width), weight_of, direction, all);
    }
    LobeSums sums;
    sums.weight = hn::GetLane(hn::SumOfLanes(d, all.weight));
    for (int c = 0; c < 3; ++c)
        sums.radiance[c] = hn::GetLane(hn::SumOfLanes(d, all.sums[c]));
    return sums;
}

LobeSums SumOverLobe(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction, double reach,
                     double nearest) {
    const double w = 0.5 * nearest;
    if (lobe.kind == LobeKind::phong)
        return SumRows(planes, direction, reach,
                       PhongWeight{lobe.parameter, w > 0 ? lobe.parameter * std::log1p(-w) : 0});
    const double x = ggx_falloff(lobe.parameter), fall = 1 + x * w;
    return SumRows(planes, direction, reach, GgxWeight{x, fall * fall / (1 - w)});
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(SumOverLobe);

LobeSums sum_over_lobe(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction, double reach,
                       double nearest) {
    return HWY_DYNAMIC_DISPATCH(SumOverLobe)(planes, lobe, direction, reach, nearest);
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

void LatLongPlanes::set_pixels(const Image& image) {
    for (std::size_t i = 0; i < stride * std::size_t(height); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            planes[c][i] = image.pixels[i * std::size_t(image.channels) + c];
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

#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reflection/maps/near_sums.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

#include "common/directions/lobes.h"
#include "common/types.h"
#include "reflection/maps/near_sums.h"

#include <algorithm>
#include <cmath>
#include <span>

#ifndef KOKAGE_NEAR_SUMS_ONCE
#define KOKAGE_NEAR_SUMS_ONCE
namespace kokage {
/// What the inner loop reads.
struct NearPixels {
    const LatLongPlanes& planes;
    std::span<const NearSums::Scratch::Row> rows;
    const float *half_sine, *half_cosine; ///< of turns by whole columns, from turn 0 on; both sides
    float* turns;                         ///< 1 - cos of the turn, from the column before the direction on; both sides
    int column;
    double fraction;
};
} // namespace kokage
#endif

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, 16>;
using Vec = hn::Vec<Tag>;

/// (1-w)^exponent
struct PhongShape {
    float exponent;
    HWY_INLINE Vec operator()(Tag d, Vec w) const {
        const auto in_front = hn::Lt(w, hn::Set(d, 1.f));
        const Vec power = hn::Mul(hn::Set(d, exponent), hn::Log1p(d, hn::Neg(hn::IfThenElseZero(in_front, w))));
        return hn::IfThenElseZero(in_front, hn::Exp(d, power));
    }
};

/// (1-w)/(1+xw)^2 (1+b) exp(-b), b = first (1+xw)
struct GgxNearShape {
    float falloff, first;
    HWY_INLINE Vec operator()(Tag d, Vec w) const {
        const Vec one = hn::Set(d, 1.f), fall = hn::MulAdd(hn::Set(d, falloff), w, one);
        const Vec b = hn::Mul(hn::Set(d, first), fall);
        const Vec whole = hn::Div(hn::Max(hn::Sub(one, w), hn::Zero(d)), hn::Mul(fall, fall));
        return hn::Mul(hn::Mul(whole, hn::Add(one, b)), hn::Exp(d, hn::Neg(b)));
    }
};

struct Accumulator {
    Vec sums[4];
};

template <class Shape>
HWY_INLINE void add_span(const LatLongPlanes& planes, const NearSums::Scratch::Row& row, const float* turns,
                         std::size_t at, std::size_t count, const Shape& shape, Accumulator& all) {
    const Tag d;
    const std::size_t lanes = hn::Lanes(d);
    const Vec height = hn::Set(d, row.height), slope = hn::Set(d, row.slope),
              angle = hn::Set(d, float(planes.row_angle[std::size_t(row.row)]));
    for (std::size_t i = 0; i < count; i += lanes) {
        const Vec w = hn::MulAdd(slope, hn::LoadU(d, turns + i), height);
        Vec weight = hn::Mul(angle, shape(d, w));
        if (count - i < lanes)
            weight = hn::IfThenElseZero(hn::FirstN(d, count - i), weight);
        for (std::size_t c = 0; c < 3; ++c)
            all.sums[c] = hn::MulAdd(weight, hn::LoadU(d, planes.planes[c].data() + at + i), all.sums[c]);
        all.sums[3] = hn::Add(all.sums[3], weight);
    }
}

/// Half angles are those of whole columns less the fraction's: differences of sines that lose no digits of the pixel.
HWY_INLINE void fill_turns(const NearPixels& pixels) {
    const Tag d;
    int begin = 0, end = 0;
    for (const NearSums::Scratch::Row& row : pixels.rows) {
        begin = std::min(begin, row.first);
        end = std::max(end, row.first + row.count);
    }
    const double turn = pixels.fraction * kPiDouble / pixels.planes.width;
    const Vec sine = hn::Set(d, float(std::sin(turn))), cosine = hn::Set(d, float(std::cos(turn)));
    for (int i = begin; i < end; i += int(hn::Lanes(d))) {
        const Vec half =
            hn::MulSub(hn::LoadU(d, pixels.half_sine + i), cosine, hn::Mul(hn::LoadU(d, pixels.half_cosine + i), sine));
        hn::StoreU(hn::Mul(hn::Add(half, half), half), d, pixels.turns + i);
    }
}

template <class Shape>
HWY_INLINE void sum(const NearPixels& pixels, const Shape& shape, double* sums) {
    const Tag d;
    const LatLongPlanes& planes = pixels.planes;
    fill_turns(pixels);
    Accumulator all{{hn::Zero(d), hn::Zero(d), hn::Zero(d), hn::Zero(d)}};
    for (const NearSums::Scratch::Row& row : pixels.rows) {
        int begin = pixels.column + row.first;
        begin += begin < 0 ? planes.width : begin >= planes.width ? -planes.width : 0;
        const std::size_t at = std::size_t(row.row) * planes.stride, count = std::size_t(row.count),
                          until_border = std::min(count, std::size_t(planes.width - begin));
        const float* turns = pixels.turns + row.first;
        add_span(planes, row, turns, at + std::size_t(begin), until_border, shape, all);
        if (until_border < count)
            add_span(planes, row, turns + until_border, at, count - until_border, shape, all);
    }
    for (std::size_t c = 0; c < 4; ++c)
        sums[c] = double(hn::GetLane(hn::SumOfLanes(d, all.sums[c])));
}

} // namespace

void SumNear(const NearPixels& pixels, const NearLobe& near, double* sums) {
    if (near.lobe.kind == LobeKind::phong)
        return sum(pixels, PhongShape{float(near.lobe.parameter)}, sums);
    const double x = ggx_falloff(near.lobe.parameter);
    sum(pixels, GgxNearShape{float(x), near.sharpest > 0 ? float(near.sharpest / x) : 0.f}, sums);
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(SumNear);

namespace {
constexpr std::size_t kPadding = 16; ///< floats in the longest vector
}

NearSums::NearSums(int image_width, int image_height)
    : planes_(image_width, image_height), before_((image_width - 1) / 2) {
    for (int i = -before_; i < image_width - before_; ++i) {
        half_sine_.push_back(float(std::sin(kPiDouble * i / image_width)));
        half_cosine_.push_back(float(std::cos(kPiDouble * i / image_width)));
    }
    half_sine_.resize(half_sine_.size() + kPadding);
    half_cosine_.resize(half_cosine_.size() + kPadding);
}

NearSums::Place NearSums::place_of(const glm::dvec3& direction) const {
    const double turn = 0.5 + std::atan2(direction.z, direction.x) / (2 * kPiDouble),
                 place = turn * planes_.width - 0.5, column = std::floor(place);
    return {std::hypot(direction.x, direction.z), direction.y, int(column), place - column};
}

/// 1 - cos of the angle between the direction and a row along its meridian, with the digits of small angles.
double NearSums::along_meridian(const Place& place, int row) const {
    const double sine = planes_.row_sine[std::size_t(row)] - place.sine,
                 cosine = planes_.row_cosine[std::size_t(row)] - place.cosine;
    return 0.5 * (sine * sine + cosine * cosine);
}

/// Of a row the pixel that is nearest in azimuth; rows from the direction's outwards, until they are farther
/// themselves.
NearSums::Nearest NearSums::nearest(const Place& place) const {
    const int column = place.column + (place.fraction < 0.5 ? 0 : 1), height = planes_.height;
    const double half_turn = (column - place.column - place.fraction) * kPiDouble / planes_.width,
                 half_sine = std::sin(half_turn), turn = 2 * half_sine * half_sine;
    const double theta = std::atan2(place.sine, place.cosine);
    const int middle = std::clamp(int(theta / kPiDouble * height), 0, height - 1);
    Nearest nearest;
    for (int away = 0; away < height; ++away) {
        bool is_farther = true;
        for (const int row : {middle - away, middle + away}) {
            if (row < 0 || row >= height)
                continue;
            const double sines = place.sine * planes_.row_sine[std::size_t(row)], meridian = along_meridian(place, row);
            is_farther = is_farther && meridian > nearest.w;
            if (const double w = meridian + sines * turn; w < nearest.w)
                nearest = {w, (column + planes_.width) % planes_.width, row};
        }
        if (is_farther)
            break;
    }
    return nearest;
}

void NearSums::find_rows(const Place& place, double reach, double nearest, Scratch& scratch) const {
    scratch.rows.clear();
    // Relative to the nearest pixel: (w - nearest) / (1 - nearest) <= reach.
    const double most = nearest + reach * (1 - nearest), scale = 1 / (1 - nearest);
    const double theta = std::atan2(place.sine, place.cosine), reach_angle = 2 * std::asin(std::sqrt(0.5 * most));
    const int width = planes_.width, height = planes_.height;
    const int begin = std::max(int((theta - reach_angle) / kPiDouble * height - 0.5), 0),
              end = std::min(int((theta + reach_angle) / kPiDouble * height + 1.5), height);
    for (int row = begin; row < end; ++row) {
        const double sines = place.sine * planes_.row_sine[std::size_t(row)], meridian = along_meridian(place, row);
        if (meridian > most)
            continue;
        int first = -before_, count = width;
        // The half span is 2 asin(s) with s^2 = (most - meridian) / (2 sines), and asin(s) < s + (pi/2 - 1) s^3 up to
        // s = 0.9.
        if (const double squared = 0.5 * (most - meridian); squared < 0.81 * sines) {
            const double s = std::sqrt(squared / sines),
                         columns = (s + (kPiDouble / 2 - 1) * s * s * s) * width / kPiDouble;
            const int from = int(std::ceil(place.fraction - columns)), to = int(std::floor(place.fraction + columns));
            if (from > first && to < first + width) {
                first = from;
                count = to - from + 1;
            }
        }
        if (count > 0)
            scratch.rows.push_back({row, first, count, float((meridian - nearest) * scale), float(sines * scale)});
    }
}

glm::dvec4 NearSums::sums(const NearLobe& near, const Place& place, double nearest, Scratch& scratch) const {
    find_rows(place, near.reach, nearest, scratch);
    scratch.turns.resize(half_sine_.size());
    glm::dvec4 sums(0);
    HWY_DYNAMIC_DISPATCH(SumNear)
    (NearPixels{planes_, scratch.rows, half_sine_.data() + before_, half_cosine_.data() + before_,
                scratch.turns.data() + before_, place.column, place.fraction},
     near, &sums.x);
    return sums;
}

glm::dvec4 NearSums::part(const NearLobe& near, const glm::dvec3& direction, Scratch& scratch) const {
    return sums(near, place_of(direction), 0, scratch);
}

glm::vec3 NearSums::whole(const NearLobe& near, const glm::dvec3& direction, Scratch& scratch) const {
    const Place place = place_of(direction);
    const Nearest pixel = nearest(place);
    if (pixel.w < 1) {
        const glm::dvec4 found = sums(near, place, near.lobe.kind == LobeKind::phong ? pixel.w : 0, scratch);
        if (found.w > 0)
            return glm::vec3(glm::dvec3(found) / found.w);
    }
    return glm::vec3(planes_.pixel(pixel.x, pixel.y));
}

} // namespace kokage
#endif

// Stockham's self-sorting transform, decimation in frequency: Van Loan 1992, Computational Frameworks for the Fast
// Fourier Transform, section 1.7.
#include "common/services/instruction_sets.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/directions/batch_fft.cpp"
#include <hwy/foreach_target.h> // IWYU pragma: keep
#include <hwy/highway.h>

#include "common/directions/batch_fft.h"
#include "common/types.h"

#include <cmath>
#include <stdexcept>
#include <utility>

HWY_BEFORE_NAMESPACE();
namespace kokage::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, BatchFft::kLanes>;
using Vec = hn::Vec<Tag>;
constexpr std::size_t kElement = BatchFft::kElement;

struct Complex {
    Vec re, im;
};
HWY_INLINE Complex operator+(const Complex& a, const Complex& b) {
    return {hn::Add(a.re, b.re), hn::Add(a.im, b.im)};
}
HWY_INLINE Complex operator-(const Complex& a, const Complex& b) {
    return {hn::Sub(a.re, b.re), hn::Sub(a.im, b.im)};
}
HWY_INLINE Complex scaled(const Complex& a, float factor) {
    const Vec f = hn::Set(Tag(), factor);
    return {hn::Mul(a.re, f), hn::Mul(a.im, f)};
}
/// -i a
HWY_INLINE Complex turned_back(const Complex& a) {
    return {a.im, hn::Neg(a.re)};
}
HWY_INLINE Complex times(const Complex& a, float re, float im) {
    const Vec r = hn::Set(Tag(), re), i = hn::Set(Tag(), im);
    return {hn::NegMulAdd(a.im, i, hn::Mul(a.re, r)), hn::MulAdd(a.re, i, hn::Mul(a.im, r))};
}
HWY_INLINE Complex load(const float* element, std::size_t real, std::size_t imaginary) {
    return {hn::LoadU(Tag(), element + real), hn::LoadU(Tag(), element + imaginary)};
}
HWY_INLINE void store(const Complex& value, float* element, std::size_t real, std::size_t imaginary) {
    hn::StoreU(value.re, Tag(), element + real);
    hn::StoreU(value.im, Tag(), element + imaginary);
}

/// Transforms of 2, 3, 4 and 5 values in place.
template <int kRadix>
HWY_INLINE void butterfly(Complex (&a)[kRadix]) {
    if constexpr (kRadix == 2) {
        const Complex sum = a[0] + a[1];
        a[1] = a[0] - a[1];
        a[0] = sum;
    } else if constexpr (kRadix == 3) {
        const Complex sum = a[1] + a[2], side = turned_back(scaled(a[1] - a[2], 0.866025404f));
        const Complex middle = a[0] - scaled(sum, 0.5f);
        a[0] = a[0] + sum;
        a[1] = middle + side;
        a[2] = middle - side;
    } else if constexpr (kRadix == 4) {
        const Complex s02 = a[0] + a[2], d02 = a[0] - a[2], s13 = a[1] + a[3], d13 = turned_back(a[1] - a[3]);
        a[0] = s02 + s13;
        a[1] = d02 + d13;
        a[2] = s02 - s13;
        a[3] = d02 - d13;
    } else {
        constexpr float c1 = 0.309016994f, c2 = -0.809016994f, s1 = 0.951056516f, s2 = 0.587785252f;
        const Complex s14 = a[1] + a[4], d14 = a[1] - a[4], s23 = a[2] + a[3], d23 = a[2] - a[3];
        const Complex m1 = a[0] + scaled(s14, c1) + scaled(s23, c2), m2 = a[0] + scaled(s14, c2) + scaled(s23, c1);
        const Complex t1 = turned_back(scaled(d14, s1) + scaled(d23, s2)),
                      t2 = turned_back(scaled(d14, s2) - scaled(d23, s1));
        a[0] = a[0] + s14 + s23;
        a[1] = m1 + t1;
        a[2] = m2 + t2;
        a[3] = m2 - t2;
        a[4] = m1 - t1;
    }
}

/// One stage: `count` = length still to transform, `stride` = product of the radices before.
template <int kRadix>
void stage(const float* HWY_RESTRICT from, float* HWY_RESTRICT to, std::size_t count, std::size_t stride,
           const float* turns, std::size_t real, std::size_t imaginary) {
    const std::size_t rest = count / kRadix, lanes = hn::Lanes(Tag());
    for (std::size_t p = 0; p < rest; ++p)
        for (std::size_t q = 0; q < stride; ++q)
            for (std::size_t lane = 0; lane < BatchFft::kLanes; lane += lanes) {
                Complex a[kRadix];
                for (std::size_t j = 0; j < kRadix; ++j)
                    a[j] = load(from + (q + stride * (p + j * rest)) * kElement + lane, real, imaginary);
                butterfly<kRadix>(a);
                float* out = to + (q + stride * kRadix * p) * kElement + lane;
                store(a[0], out, real, imaginary);
                for (std::size_t k = 1; k < kRadix; ++k) {
                    const float* turn = turns + 2 * (p * k * stride);
                    store(times(a[k], turn[0], turn[1]), out + k * stride * kElement, real, imaginary);
                }
            }
}

/// The same for any radix, by the definition.
void general_stage(const float* HWY_RESTRICT from, float* HWY_RESTRICT to, std::size_t count, std::size_t stride,
                   std::size_t radix, std::size_t length, const float* turns, std::size_t real, std::size_t imaginary) {
    const std::size_t rest = count / radix, lanes = hn::Lanes(Tag());
    for (std::size_t p = 0; p < rest; ++p)
        for (std::size_t q = 0; q < stride; ++q)
            for (std::size_t k = 0; k < radix; ++k)
                for (std::size_t lane = 0; lane < BatchFft::kLanes; lane += lanes) {
                    Complex sum{hn::Zero(Tag()), hn::Zero(Tag())};
                    for (std::size_t j = 0; j < radix; ++j) {
                        const float* turn = turns + 2 * (j * k % radix * (length / radix));
                        sum = sum + times(load(from + (q + stride * (p + j * rest)) * kElement + lane, real, imaginary),
                                          turn[0], turn[1]);
                    }
                    const float* turn = turns + 2 * (p * k * stride);
                    store(times(sum, turn[0], turn[1]), to + (q + stride * (radix * p + k)) * kElement + lane, real,
                          imaginary);
                }
}

} // namespace

void FftStage(const float* from, float* to, std::size_t count, std::size_t stride, int radix, std::size_t length,
              const float* turns, std::size_t real, std::size_t imaginary) {
    switch (radix) {
    case 2:
        return stage<2>(from, to, count, stride, turns, real, imaginary);
    case 3:
        return stage<3>(from, to, count, stride, turns, real, imaginary);
    case 4:
        return stage<4>(from, to, count, stride, turns, real, imaginary);
    case 5:
        return stage<5>(from, to, count, stride, turns, real, imaginary);
    default:
        return general_stage(from, to, count, stride, std::size_t(radix), length, turns, real, imaginary);
    }
}

} // namespace kokage::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace kokage {

HWY_EXPORT(FftStage);

BatchFft::BatchFft(int length) : length_(length) {
    if (length < 1)
        throw std::invalid_argument("BatchFft: the length must be at least 1");
    int rest = length;
    for (const int radix : {4, 2, 3, 5})
        for (; rest % radix == 0; rest /= radix)
            factors_.push_back(radix);
    for (int radix = 7; rest > 1; radix += 2)
        for (; rest % radix == 0; rest /= radix)
            factors_.push_back(radix);
    for (int k = 0; k < length; ++k) {
        const double angle = 2 * kPiDouble * k / length;
        turns_.push_back(float(std::cos(angle)));
        turns_.push_back(float(-std::sin(angle)));
    }
}

std::span<float> BatchFft::transform(std::span<float> values, std::span<float> scratch, std::size_t real,
                                     std::size_t imaginary) const {
    if (values.size() < floats() || scratch.size() < floats())
        throw std::invalid_argument("BatchFft: too little room");
    std::size_t count = std::size_t(length_), stride = 1;
    for (const int radix : factors_) {
        HWY_DYNAMIC_DISPATCH(FftStage)
        (values.data(), scratch.data(), count, stride, radix, std::size_t(length_), turns_.data(), real, imaginary);
        count /= std::size_t(radix);
        stride *= std::size_t(radix);
        std::swap(values, scratch);
    }
    return values;
}

std::span<float> BatchFft::forward(std::span<float> values, std::span<float> scratch) const {
    return transform(values, scratch, 0, kLanes);
}

// The conjugate transform is the same with real and imaginary parts exchanged on the way in and out.
std::span<float> BatchFft::backward(std::span<float> values, std::span<float> scratch) const {
    return transform(values, scratch, kLanes, 0);
}

} // namespace kokage
#endif

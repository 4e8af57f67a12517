#include "common/directions/legendre.h"
#include "common/directions/ring_transform.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace kokage {
namespace {

constexpr int kPad = RingCoefficients::kPad;

/// Replaces values on the rings (j + 1/2) pi / n of one order m, for all j < n, by coefficients of the cubic B-spline
/// that takes these values. Over a pole the meridian goes on at azimuth + pi, where order m is (-1)^m as large, so
/// that a meridian is a circle. Unser, Aldroubi and Eden 1993, "B-spline signal processing: part II", eqs 2.5.
void spline_coefficients(std::vector<double>& values, bool odd, std::vector<double>& circle) {
    constexpr int kRun = 40; // z^40 = 1e-23
    const double z = std::sqrt(3.0) - 2, gain = -6 * z;
    const int n = int(values.size());
    auto on_circle = [&](int j) { // 2n rings around
        j = ((j % (2 * n)) + 2 * n) % (2 * n);
        return j < n ? values[std::size_t(j)] : (odd ? -1.0 : 1.0) * values[std::size_t(2 * n - 1 - j)];
    };
    circle.resize(std::size_t(n + 2 * kRun));
    double sum = 0;
    for (int j = -2 * kRun; j < n + kRun; ++j) {
        sum = on_circle(j) + z * sum;
        if (j >= -kRun)
            circle[std::size_t(j + kRun)] = sum;
    }
    sum = 0;
    for (int j = n + kRun - 1; j >= 0; --j) {
        sum = circle[std::size_t(j + kRun)] + z * sum;
        if (j < n)
            values[std::size_t(j)] = gain * sum;
    }
}

} // namespace

RingTables::RingTables(int bands, int rings, std::span<const double> polar, std::span<const double> weights,
                       bool spline, Order order)
    : bands_(bands), rings_(rings) {
    if (bands < 1 || rings < 1 || polar.size() != std::size_t(pairs()) ||
        (!weights.empty() && weights.size() != polar.size()))
        throw std::invalid_argument("RingTables: bands, rings and angles don't agree");
    const RingCoefficients shape(bands);
    std::size_t size = 0;
    for (int m = 0; m < bands; ++m) {
        for (int parity = 0; parity < 2; ++parity) {
            first_.push_back(size);
            size += order == Order::along_bands ? std::size_t(pairs()) * std::size_t(shape.padded(m, parity))
                                                : std::size_t(shape.count(m, parity)) * std::size_t(padded_pairs());
        }
        // P_lm is below 1e-12 of its largest value where (l sin / m) is so far below 1; kept simple and safe.
        int first = 0;
        const double reach = (m - 6.5 * std::cbrt(double(m)) - 12) / bands;
        while (first < pairs() && std::sin(polar[std::size_t(first)]) < reach)
            ++first;
        first_pair_.push_back(first / kPad * kPad);
    }
    values_.resize(size);
    std::fill(values_.begin(), values_.end(), 0.f);

    parallel_blocks(std::size_t(bands), 4, [&](std::size_t begin, std::size_t end) {
        std::vector<double> functions, column(static_cast<std::size_t>(bands)), ring_values, circle;
        for (int m = int(begin); m < int(end); ++m) {
            const std::size_t count = std::size_t(bands - m);
            functions.assign(count * std::size_t(pairs()), 0); // [l - m][pair]
            for (std::size_t pair = 0; pair < std::size_t(pairs()); ++pair) {
                polar_factors(bands, m, std::cos(polar[pair]), column);
                const double factor = std::pow(std::sin(polar[pair]), m) * (weights.empty() ? 1 : weights[pair]);
                for (std::size_t i = 0; i < count; ++i)
                    functions[i * std::size_t(pairs()) + pair] = factor * column[i];
            }
            for (std::size_t i = 0; i < count; ++i) {
                double* north = functions.data() + i * std::size_t(pairs());
                if (spline) {
                    ring_values.resize(std::size_t(rings));
                    for (int j = 0; j < pairs(); ++j) {
                        ring_values[std::size_t(rings - 1 - j)] = (i % 2 ? -1.0 : 1.0) * north[j];
                        ring_values[std::size_t(j)] = north[j];
                    }
                    spline_coefficients(ring_values, m % 2 != 0, circle);
                    std::copy_n(ring_values.begin(), pairs(), north);
                }
                const int parity = int(i % 2);
                float* values = values_.data() + first_[std::size_t(2 * m + parity)];
                for (std::size_t pair = 0; pair < std::size_t(pairs()); ++pair)
                    values[order == Order::along_bands ? pair * std::size_t(shape.padded(m, parity)) + i / 2
                                                       : i / 2 * std::size_t(padded_pairs()) + pair] =
                        float(north[pair]);
            }
        }
    });
}

} // namespace kokage

#include "common/directions/legendre.h"
#include "common/directions/ring_transform.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace kokage {
namespace {

/// P_lm of one order m on all northern rings: row by row, [pair][l - m].
class OrderTable {
  public:
    OrderTable(int bands, int rings, std::span<const double> polar, std::span<const double> weights)
        : bands_(bands), rings_(rings), polar_(polar), weights_(weights) {}

    /// The recurrence of legendre.h's polar_factors(), for several rings at once.
    void fill(int m) {
        count_ = std::size_t(bands_ - m);
        odd_ = m % 2 != 0;
        values_.resize(polar_.size() * count_);
        std::vector<double> first(1), up(count_), back(count_);
        polar_factors(m + 1, m, 0, first);
        auto factor = [m](int l) { return std::sqrt((4.0 * l * l - 1) / (double(l) * l - double(m) * m)); };
        for (std::size_t i = 1; i < count_; ++i) {
            up[i] = factor(m + int(i));
            back[i] = i > 1 ? up[i] / up[i - 1] : 0;
        }
        constexpr std::size_t kAtOnce = 8;
        for (std::size_t begin = 0; begin < polar_.size(); begin += kAtOnce) {
            std::array<double, kAtOnce> height, now, before{};
            for (std::size_t k = 0; k < kAtOnce; ++k) {
                const std::size_t pair = std::min(begin + k, polar_.size() - 1);
                height[k] = std::cos(polar_[pair]);
                now[k] = first[0] * std::pow(std::sin(polar_[pair]), m) * (weights_.empty() ? 1 : weights_[pair]);
            }
            const std::size_t here = std::min(kAtOnce, polar_.size() - begin);
            double* rows = values_.data() + begin * count_;
            for (std::size_t i = 0; i < count_; ++i) {
                if (i > 0)
                    for (std::size_t k = 0; k < kAtOnce; ++k) {
                        const double next = up[i] * height[k] * now[k] - back[i] * before[k];
                        before[k] = now[k];
                        now[k] = next;
                    }
                for (std::size_t k = 0; k < here; ++k)
                    rows[k * count_ + i] = now[k];
            }
        }
    }

    /// Replaces the values on the rings (j + 1/2) pi / n by the coefficients of the spline (kRingSpline) that takes
    /// these values. Over a pole the meridian goes on at azimuth + pi, where order m is (-1)^m as large, so that a
    /// meridian is a circle. The inverse of (4, 13, 4) / 21 is a run down and a run up with its pole z: Unser, Aldroubi
    /// and Eden 1993, "B-spline signal processing: part II", eq 2.5.
    void make_spline() {
        constexpr int kRun = 28; // z^28 = 1e-13
        const double z = (std::sqrt(105.0) - 13) / 8, gain = -z * 21 / 4;
        const int pairs = int(polar_.size()), end = pairs + kRun;
        runs_.resize(std::size_t(end) * count_);
        std::vector<double> sum(count_);
        for (int j = -kRun; j < end; ++j) {
            double even_sign = 0, odd_sign = 0;
            const double* row = ring(j, even_sign, odd_sign);
            for (std::size_t i = 0; i + 1 < count_; i += 2) {
                sum[i] = even_sign * row[i] + z * sum[i];
                sum[i + 1] = odd_sign * row[i + 1] + z * sum[i + 1];
            }
            if (count_ % 2 != 0)
                sum[count_ - 1] = even_sign * row[count_ - 1] + z * sum[count_ - 1];
            if (j >= 0)
                std::copy(sum.begin(), sum.end(), runs_.begin() + std::ptrdiff_t(std::size_t(j) * count_));
        }
        std::fill(sum.begin(), sum.end(), 0.0);
        for (int j = end - 1; j >= 0; --j) {
            const double* run = runs_.data() + std::size_t(j) * count_;
            for (std::size_t i = 0; i < count_; ++i)
                sum[i] = gain * run[i] + z * sum[i];
            if (j < pairs)
                std::copy(sum.begin(), sum.end(), values_.begin() + std::ptrdiff_t(std::size_t(j) * count_));
        }
    }

    const double* row(std::size_t pair) const { return values_.data() + pair * count_; }
    std::size_t count() const { return count_; }

  private:
    /// Ring j of the circle: the northern row that it mirrors, and the signs of even and odd l - m there.
    const double* ring(int j, double& even_sign, double& odd_sign) const {
        const int circle = ((j % (2 * rings_)) + 2 * rings_) % (2 * rings_);
        const bool beyond_pole = circle >= rings_;
        const int on_meridian = beyond_pole ? 2 * rings_ - 1 - circle : circle;
        const bool south = on_meridian >= int(polar_.size());
        even_sign = beyond_pole && odd_ ? -1 : 1;
        odd_sign = south ? -even_sign : even_sign;
        return row(std::size_t(south ? rings_ - 1 - on_meridian : on_meridian));
    }

    int bands_, rings_;
    std::span<const double> polar_, weights_;
    bool odd_ = false;
    std::size_t count_ = 0;
    std::vector<double> values_, runs_;
};

} // namespace

RingTables::RingTables(int bands, int rings, std::span<const double> polar, std::span<const double> weights,
                       bool spline, Order order, std::span<const float> stored)
    : bands_(bands), rings_(rings) {
    if (bands < 1 || rings < 1 || polar.size() != std::size_t(pairs()) ||
        (!weights.empty() && weights.size() != polar.size()))
        throw std::invalid_argument("RingTables: bands, rings and angles don't agree");
    const RingCoefficients shape(bands);
    std::size_t size = 0;
    first_.resize(std::size_t(batches() * bands * 2));
    for (int batch = 0; batch < batches(); ++batch) {
        // P_lm is below 1e-12 of its largest value where l sin is so far below m.
        const double sine = std::sin(polar[std::size_t(std::min((batch + 1) * kBatch, pairs()) - 1)]);
        int orders = 1;
        while (orders < bands && sine * bands >= orders - 6.5 * std::cbrt(double(orders)) - 12)
            ++orders;
        orders_.push_back(orders);
    }
    auto place = [&](int batch, int m, int parity) {
        first_[std::size_t((batch * bands + m) * 2 + parity)] = size;
        const int here = std::min(kBatch, pairs() - batch * kBatch);
        size += m >= orders_[std::size_t(batch)] ? 0
                : order == Order::along_bands    ? std::size_t(here) * std::size_t(shape.padded(m, parity))
                                                 : std::size_t(shape.count(m, parity)) * std::size_t(kBatch);
    };
    // In the order in which they are gone through.
    if (order == Order::along_bands) {
        for (int m = 0; m < bands; ++m)
            for (int parity = 0; parity < 2; ++parity)
                for (int batch = 0; batch < batches(); ++batch)
                    place(batch, m, parity);
    } else {
        for (int batch = 0; batch < batches(); ++batch)
            for (int m = 0; m < bands; ++m)
                for (int parity = 0; parity < 2; ++parity)
                    place(batch, m, parity);
    }
    values_.resize(size);
    if (!stored.empty()) {
        if (stored.size() < size)
            throw std::invalid_argument("RingTables: the stored tables are too short");
        std::copy_n(stored.begin(), size, values_.begin());
        return;
    }
    parallel_blocks(std::size_t(bands), 4, [&](std::size_t begin, std::size_t end) {
        OrderTable functions(bands, rings, polar, weights);
        for (int m = int(begin); m < int(end); ++m) {
            functions.fill(m);
            if (spline)
                functions.make_spline();
            for (int batch = 0; batch < batches(); ++batch)
                for (int parity = 0; parity < 2 && m < orders(batch); ++parity) {
                    float* values = values_.data() + first_[std::size_t((batch * bands + m) * 2 + parity)];
                    const auto count = std::size_t(shape.count(m, parity)),
                               padded = std::size_t(shape.padded(m, parity));
                    for (int lane = 0; lane < kBatch; ++lane) {
                        const int pair = batch * kBatch + lane;
                        const double* row = pair < pairs() ? functions.row(std::size_t(pair)) + parity : nullptr;
                        if (order == Order::along_bands) {
                            for (std::size_t i = 0; row && i < padded; ++i)
                                values[std::size_t(lane) * padded + i] = i < count ? float(row[2 * i]) : 0.f;
                        } else {
                            for (std::size_t i = 0; i < count; ++i)
                                values[i * std::size_t(kBatch) + std::size_t(lane)] = row ? float(row[2 * i]) : 0.f;
                        }
                    }
                }
        }
    });
}

} // namespace kokage

#include "common/directions/legendre.h"
#include "common/types.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace kokage {
namespace {

constexpr int table_bands = 64;

/// N_lm = a_lm (z N_{l-1,m} - N_{l-2,m} / a_{l-1,m}): the recurrence of fully normalised functions needs this one
/// number.
double recurrence_factor(int l, int m) {
    return std::sqrt((4.0 * l * l - 1) / (double(l) * l - double(m) * m));
}

/// N_mm, which is constant: the product of (2k+1)/(2k) under the root, times 1/(4 pi), and 2 for m > 0.
double first_factor(int m) {
    double product = 1 / (4 * kPiDouble);
    for (int k = 1; k <= m; ++k)
        product *= (2.0 * k + 1) / (2.0 * k);
    return std::sqrt(m > 0 ? 2 * product : product);
}

struct Tables {
    std::array<double, table_bands> first;
    std::array<double, table_bands * table_bands> factor, inverse; ///< [m * table_bands + l]
    Tables() : first(), factor(), inverse() {
        for (int m = 0; m < table_bands; ++m) {
            first[std::size_t(m)] = first_factor(m);
            for (int l = m + 1; l < table_bands; ++l) {
                factor[std::size_t(m * table_bands + l)] = recurrence_factor(l, m);
                inverse[std::size_t(m * table_bands + l)] = 1 / recurrence_factor(l, m);
            }
        }
    }
};

void polar_factors_by_table(int bands, int m, double z, double* values) {
    static const Tables tables;
    const double* factor = tables.factor.data() + m * table_bands;
    const double* inverse = tables.inverse.data() + m * table_bands;
    values[0] = tables.first[std::size_t(m)];
    if (bands - m > 1)
        values[1] = factor[m + 1] * z * values[0];
    for (int l = m + 2; l < bands; ++l)
        values[l - m] = factor[l] * (z * values[l - m - 1] - values[l - m - 2] * inverse[l - 1]);
}

} // namespace

void legendre_polynomials(double x, std::span<double> values) {
    if (!values.empty())
        values[0] = 1;
    if (values.size() > 1)
        values[1] = x;
    for (std::size_t l = 2; l < values.size(); ++l)
        values[l] = ((2.0 * double(l) - 1) * x * values[l - 1] - (double(l) - 1) * values[l - 2]) / double(l);
}

void polar_factors(int bands, int m, double z, std::span<double> values) {
    if (m >= bands)
        return;
    if (bands <= table_bands)
        return polar_factors_by_table(bands, m, z, values.data());
    values[0] = first_factor(m);
    double before = 0;
    for (int l = m + 1; l < bands; ++l) {
        const double factor = recurrence_factor(l, m);
        const double previous = l > m + 1 ? values[std::size_t(l - m - 2)] / before : 0;
        values[std::size_t(l - m)] = factor * (z * values[std::size_t(l - m - 1)] - previous);
        before = factor;
    }
}

std::vector<QuadratureNode> gauss_legendre(int n) {
    std::vector<QuadratureNode> nodes(static_cast<std::size_t>(n));
    for (int i = 0; i < (n + 1) / 2; ++i) {
        // Newton's method from Tricomi's estimate of the root; P_n and its derivative by Bonnet's recurrence.
        double x = -std::cos(kPiDouble * (i + 0.75) / (n + 0.5)), derivative = 1;
        for (int step = 0; step < 100; ++step) {
            double current = 1, previous = 0;
            for (int l = 1; l <= n; ++l) {
                const double next = ((2.0 * l - 1) * x * current - (l - 1.0) * previous) / l;
                previous = current;
                current = next;
            }
            derivative = n * (x * current - previous) / (x * x - 1);
            const double change = current / derivative;
            x -= change;
            if (std::abs(change) < 1e-15)
                break;
        }
        if (2 * i + 1 == n)
            x = 0;
        const double weight = 2 / ((1 - x * x) * derivative * derivative);
        nodes[std::size_t(i)] = {x, weight};
        nodes[std::size_t(n - 1 - i)] = {-x, weight};
    }
    return nodes;
}

} // namespace kokage

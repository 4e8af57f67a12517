#include "common/directions/lobes.h"
#include "common/directions/legendre.h"
#include "common/types.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace kokage {

std::vector<double> cosine_lobe(int bands) {
    std::vector<double> k(std::size_t(std::max(bands, 0)));
    double central = 1; // l! / (2^l ((l/2)!)^2) = binomial(l, l/2) / 2^l, with its alternating sign
    for (int l = 0; l < bands; ++l) {
        double& value = k[std::size_t(l)];
        if (l == 1) {
            value = 2 * kPiDouble / 3;
        } else if (l % 2 == 0) {
            value = -2 * kPiDouble * central / ((l + 2.0) * (l - 1.0));
            central *= -(l + 1.0) / (l + 2.0);
        }
    }
    return k;
}

std::vector<double> two_sided_cosine_lobe(int bands) {
    std::vector<double> k = cosine_lobe(bands);
    for (std::size_t l = 0; l < k.size(); ++l)
        k[l] = l % 2 == 0 ? 2 * k[l] : 0;
    return k;
}

std::vector<double> phong_lobe(int bands, double exponent) {
    std::vector<double> k(std::size_t(std::max(bands, 0)));
    for (int l = 0; l < bands; ++l) {
        if (l == 0)
            k[0] = 1;
        else if (l == 1)
            k[1] = (exponent + 1) / (exponent + 2);
        else
            k[std::size_t(l)] = k[std::size_t(l) - 2] * (exponent - (l - 2)) / (exponent + l + 1);
    }
    return k;
}

double phong_lobe_value(double exponent, double squared_distance) {
    const double one_minus_cosine = 0.5 * squared_distance;
    if (one_minus_cosine > 1)
        return 0;
    const double power =
        one_minus_cosine == 1 ? (exponent == 0 ? 1 : 0) : std::exp(exponent * std::log1p(-one_minus_cosine));
    return (exponent + 1) / (2 * kPiDouble) * power;
}

std::vector<double> cone_lobe(int bands, double half_angle) {
    std::vector<double> k(std::size_t(std::max(bands, 0)), 1.0);
    const double half_sine = std::sin(0.5 * half_angle), height = 2 * half_sine * half_sine; // 1 - cos
    if (!(height > 0))
        return k;
    // Integral of P_l over [c, 1] = (1 - c^2) P_l'(c) / (l (l+1)). Written by d_l = 1 - P_l(c), which keeps its digits
    // for small cones: Bonnet's recurrence gives d_{l+1} = d_l + l/(l+1) (d_l - d_{l-1}) + (2l+1)/(l+1) height (1 -
    // d_l), and integral = (P_{l-1} - P_{l+1})/(2l+1) = (d_{l+1} - d_{l-1})/(2l+1).
    double before = 0, current = height; // d_0, d_1
    for (int l = 1; l < bands; ++l) {
        const double next =
            current + l / (l + 1.0) * (current - before) + (2 * l + 1.0) / (l + 1.0) * height * (1 - current);
        k[std::size_t(l)] = (next - before) / ((2 * l + 1.0) * height);
        before = current;
        current = next;
    }
    return k;
}

} // namespace kokage

#include "common/directions/lobes.h"
#include "common/directions/legendre.h"
#include "common/types.h"

#include <Eigen/Core>
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

double ggx_falloff(double roughness) {
    const double alpha = roughness * roughness;
    return (1 - alpha) * (1 + alpha) / (2 * alpha * alpha);
}

namespace {

/// Integral of (1-w)/(1+xw)^2 over w in [0,1] = (x - log(1+x))/x^2.
double ggx_mass(double x) {
    if (x > 0.1)
        return (x - std::log1p(x)) / (x * x);
    double sum = 0, power = 1; // its series at 0, where the difference loses digits
    for (int n = 0; n < 20; ++n, power *= -x)
        sum += power / (n + 2);
    return sum;
}

/// Pieces of [0, pi/2] that 24 nodes integrate to the last digit: each short beside its distance from the poles of
/// h at angles +-i sqrt(2/x) (or the width of the smooth part's sharpest lobe), and no longer than 16 radians of the
/// fastest Legendre polynomial's phase.
std::vector<double> ggx_pieces(double sharpness, int bands) {
    const double end = kPiDouble / 2, longest = 16.0 / std::max(bands, 1);
    std::vector<double> borders{0};
    double next = std::sqrt(2 / std::max(sharpness, 1.0));
    while (borders.back() < end) {
        borders.push_back(std::min({next, borders.back() + longest, end}));
        next = std::max(next, 1.5 * borders.back());
    }
    return borders;
}

/// Adds to k the integrals of part(w) (1-w)/(1+xw)^2 / mass, w = 1 - t, times the Legendre polynomials.
template <class Part>
void add_ggx_integrals(std::vector<double>& k, double x, double sharpness, const Part& part) {
    const int bands = int(k.size());
    const double mass = ggx_mass(x);
    const std::vector<double> borders = ggx_pieces(sharpness, bands);
    constexpr int nodes = 24;
    using Nodes = Eigen::Array<double, nodes, 1>; // together, as vectors
    static const std::vector<QuadratureNode> rule = gauss_legendre(nodes);
    for (std::size_t piece = 1; piece < borders.size(); ++piece) {
        const double half = 0.5 * (borders[piece] - borders[piece - 1]),
                     middle = 0.5 * (borders[piece] + borders[piece - 1]);
        Nodes w, weight; // w = 1 - t
        for (int i = 0; i < nodes; ++i) {
            const double angle = middle + half * rule[std::size_t(i)].x, half_sine = std::sin(0.5 * angle);
            w[i] = 2 * half_sine * half_sine;
            const double fall = 1 + x * w[i];
            weight[i] =
                part(w[i]) * half * rule[std::size_t(i)].weight * std::sin(angle) * (1 - w[i]) / (fall * fall * mass);
        }
        k[0] += weight.sum();
        // Bonnet's recurrence for d_l = 1 - P_l(t), by its steps: keeps its digits where t is almost 1.
        Nodes d = w, step = w;
        for (int l = 1; l < bands; ++l) {
            const Nodes legendre = 1 - d;
            k[std::size_t(l)] += (weight * legendre).sum();
            step = l / (l + 1.0) * step + (2 * l + 1) / (l + 1.0) * w * legendre;
            d += step;
        }
    }
}

/// 1 - (1+b) exp(-b)
double smooth_factor(double b) {
    if (b > 0.5)
        return 1 - (1 + b) * std::exp(-b);
    double sum = 0, term = b * b / 2; // its series, where the difference loses digits: (-1)^n (n-1) b^n / n!
    for (int n = 2; n < 16; ++n, term *= -b / n)
        sum += (n - 1) * term;
    return sum;
}

} // namespace

std::vector<double> ggx_lobe(int bands, double roughness) {
    std::vector<double> k(std::size_t(std::max(bands, 0)), 1.0);
    if (bands <= 1 || !(roughness > 0))
        return k;
    const double x = ggx_falloff(roughness);
    std::fill(k.begin(), k.end(), 0.0);
    add_ggx_integrals(k, x, x, [](double) { return 1.0; });
    k[0] = 1;
    return k;
}

std::vector<double> ggx_smooth_part(int bands, double roughness, double sharpest) {
    std::vector<double> k(std::size_t(std::max(bands, 0)), 0.0);
    const double x = ggx_falloff(roughness);
    if (bands > 0)
        add_ggx_integrals(k, x, std::min(x, sharpest), [&](double w) {
            return x > 0 ? smooth_factor(sharpest * (1 / x + w)) : 1.0; // u = 1/x
        });
    return k;
}

double ggx_smooth_share(double roughness, double sharpest) {
    const double x = ggx_falloff(roughness), first = sharpest / x, last = first + sharpest; // b at w = 0 and 1
    constexpr double kNothing = 40;                                                         // exp(-b) beyond
    if (!(first < kNothing))
        return 1;
    // The near part's mass, with dw = db/sharpest and 1 - w = 1 + u - b/sharpest: integrals over b of
    // (1+b) exp(-b)/b^2 = -(exp(-b)/b)' and of (1+b) exp(-b)/b = -(E1(b) + exp(-b))'.
    const double from = std::exp(-first), to = std::exp(-last);
    const double near =
        (1 + 1 / x) * sharpest * (from / first - to / last) - (from - std::expint(-first) - to + std::expint(-last));
    return 1 - near / (x * x * ggx_mass(x));
}

double ggx_lobe_value(double roughness, double squared_distance) {
    const double w = 0.5 * squared_distance;
    if (w > 1)
        return 0;
    const double x = ggx_falloff(roughness), fall = 1 + x * w;
    return (1 - w) / (fall * fall * 2 * kPiDouble * ggx_mass(x));
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

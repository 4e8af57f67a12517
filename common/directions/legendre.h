#pragma once
// Legendre polynomials, their normalised associated functions, and Gauss-Legendre quadrature.
#include <span>
#include <vector>

namespace kokage {

/// P_0(x) ... P_{n-1}(x), n = values.size(), by Bonnet's recurrence (stable for |x| <= 1).
void legendre_polynomials(double x, std::span<double> values);

/// The part of harmonics of order m >= 0 that depends on the polar angle alone: values[l - m] = N_lm(z) for l = m ...
/// bands-1, with
///     Y_l,m = N_lm(z) Re (x + iy)^m,   Y_l,-m = N_lm(z) Im (x + iy)^m
/// in a unit direction (x, y, z), normalisation and the sqrt(2) of m > 0 included, no Condon-Shortley phase.
/// values.size() >= bands - m. Finite for at least 1024 bands. Upward recurrence in l (Press et al., Numerical Recipes,
/// 3rd ed., eq 6.7.9).
void polar_factors(int bands, int m, double z, std::span<double> values);

struct QuadratureNode {
    double x, weight;
};
/// The n nodes in (-1, 1), ascending, whose weighted sum integrates every polynomial of degree <= 2n - 1 exactly. n
/// >= 1.
std::vector<QuadratureNode> gauss_legendre(int n);

} // namespace kokage

#pragma once
// Zonal functions h(cos angle), and convolution with them.
//
// Zonal coefficients of h are k_l = 2 pi * integral of h(t) P_l(t) over t in [-1, 1]. By the theorem of Funk and Hecke,
//     g(n) = integral over the sphere of f(d) h(n . d)     has the coefficients     g_lm = k_l f_lm,
// so a normalised h has k_0 = 1 and a constant stays itself.
#include "common/directions/spherical_harmonics.h"

#include <functional>
#include <span>
#include <type_traits>
#include <vector>

namespace kokage {

/// Multiplies band l of `coefficients` (bands^2 of double, float or glm::vec3) by zonal[l]; bands without a zonal
/// coefficient become 0.
template <typename Value>
void convolve_zonal(std::span<Value> coefficients, std::span<const double> zonal) {
    const int bands = sh_bands(coefficients.size());
    for (int l = 0; l < bands; ++l) {
        const double factor = std::size_t(l) < zonal.size() ? zonal[std::size_t(l)] : 0.0;
        for (int m = -l; m <= l; ++m)
            if constexpr (std::is_same_v<Value, double>)
                coefficients[sh_index(l, m)] *= factor;
            else
                coefficients[sh_index(l, m)] *= float(factor);
    }
}

/// Adds a lobe around a unit direction: coefficients += amount * k_l Y_lm(direction). With zonal coefficients all 1 it
/// is light from exactly that direction, `amount` its irradiance.
void add_zonal(std::span<glm::vec3> coefficients, const glm::vec3& direction, const glm::vec3& amount,
               std::span<const double> zonal);

/// Value of a zonal function given by its coefficients at the cosine t: sum of (2l+1)/(4 pi) k_l P_l(t).
double evaluate_zonal(std::span<const double> zonal, double t);

/// Zonal coefficients of any h, by Gauss-Legendre quadrature on each piece between consecutive `breaks` (ascending,
/// within [-1, 1]; put one where h has a kink or ends). Exact where h is a polynomial of degree <= 2 nodes - bands on
/// each piece.
std::vector<double> zonal_coefficients(int bands, const std::function<double(double)>& h,
                                       std::span<const double> breaks, int nodes);

} // namespace kokage

#pragma once
// Reflection lobes and their zonal coefficients (zonal.h), analytic for every l.
#include <vector>

namespace kokage {

/// Clamped cosine max(t, 0), not normalised: irradiance of a surface. k_0 = pi, k_1 = 2 pi/3, k_2 = pi/4, odd l > 1: 0.
/// Ramamoorthi and Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps", eq 8, there times
/// sqrt(4 pi/(2l+1)).
std::vector<double> cosine_lobe(int bands);

/// |t|: the sum of what both sides of a leaf receive. Even l: twice the clamped cosine's; odd l: 0.
std::vector<double> two_sided_cosine_lobe(int bands);

/// Phong's lobe (exponent+1)/(2 pi) max(t, 0)^exponent, normalised to 1. exponent >= 0.
/// k_0 = 1, k_1 = (L+1)/(L+2), k_{l+2} = k_l (L-l)/(L+l+3), from integrating Bonnet's recurrence by parts.
std::vector<double> phong_lobe(int bands, double exponent);
/// Its value between unit directions a and b, from their squared distance |a-b|^2: exp(L log1p(-|a-b|^2/2)), which
/// keeps its digits for large exponents where a rounded dot product would not.
double phong_lobe_value(double exponent, double squared_distance);

/// GGX as glTF's roughness means it (alpha = roughness^2), seen along the normal (n = v = r, Karis 2013, "Real Shading
/// in Unreal Engine 4"), weighted by n.l as prefiltered maps of engines are, and normalised to 1:
///     h(t) ~ D(cos(theta/2)) max(t, 0) ~ max(t, 0) / (1 + x (1-t))^2,   x = (1 - alpha^2)/(2 alpha^2).
/// roughness in [0, 1]; 1 is the cosine lobe, 0 the mirror (all k_l = 1; it has no value).
/// Coefficients by Gauss-Legendre quadrature graded towards the peak: error 1e-14 up to 2000 bands. Time grows with
/// bands^2: 1.5 ms for 1024.
std::vector<double> ggx_lobe(int bands, double roughness);
/// Its value between unit directions a and b, from their squared distance |a-b|^2. roughness > 0.
double ggx_lobe_value(double roughness, double squared_distance);
/// x above: how fast the lobe falls from its peak. 0 at roughness 1; roughness > 0.
double ggx_falloff(double roughness);

// GGX in two parts, as Ewald 1921 ("Die Berechnung optischer und elektrostatischer Gitterpotentiale", Annalen der
// Physik 369(3)) split potentials: with w = 1 - t and u = 1/x,
//     1/(u+w)^2 = integral over p > 0 of p exp(-p (u+w)) dp
// is a mixture of lobes exp(-p w). Those with p up to `sharpest` are the smooth part, which few bands hold however
// narrow the lobe is; the others the near part, which ends soon:
//     near part / whole = (1+b) exp(-b),   b = sharpest (u+w).
/// Zonal coefficients of the smooth part; k_0 is its share of the whole lobe's mass. roughness in (0, 1].
std::vector<double> ggx_smooth_part(int bands, double roughness, double sharpest);
/// That k_0 in closed form; absolute error 1e-14.
double ggx_smooth_share(double roughness, double sharpest);

/// Uniform over a cone, normalised to 1: the disc of a sun. half_angle in radians, 0 (all k_l = 1) to pi.
std::vector<double> cone_lobe(int bands, double half_angle);

} // namespace kokage

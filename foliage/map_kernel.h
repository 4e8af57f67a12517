#pragma once
// What turns a light-environment map into one that never shows negative light, and into irradiance.
#include <vector>

namespace kokage {

/// Zonal factors of a kernel of `bands` bands that is nowhere negative and has unit mass: the squared Dirichlet kernel
/// K(g) = (sum_{l < L} (2l+1) P_l(cos g))^2 / norm, L = (bands + 1) / 2, which is a polynomial of degree 2L - 2 <
/// bands. A map whose bands are multiplied by them is a convex mean of what was captured: no ringing, and bounces read
/// from it cannot gain energy.
std::vector<double> squared_dirichlet_factors(int bands);

/// Zonal factors A_l of the clamped cosine: irradiance E_lm = A_l L_lm. A_0 = pi, A_1 = 2pi/3, 0 for odd l > 1, else
/// 2pi (-1)^(l/2-1) / ((l+2)(l-1)) l! / (2^l (l/2)!^2)  (Ramamoorthi and Hanrahan 2001, eq 8).
std::vector<double> clamped_cosine_factors(int bands);

} // namespace kokage

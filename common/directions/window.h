#pragma once
// Windows: factors per band that damp the ringing of truncated spherical harmonics.
#include <string_view>
#include <vector>

namespace kokage {

enum class Window {
    none,              ///< 1 in every band
    hann,              ///< (1 + cos(pi l / bands)) / 2; ringing nearly gone, negative values still possible
    lanczos,           ///< sin(x)/x, x = pi l / bands
    non_negative,      ///< of all kernels of so many bands that are nowhere negative, the sharpest; see below
    squared_dirichlet, ///< (sum of (2l+1) P_l)^2, nowhere negative either, less sharp
};

/// Factor k_l of each band, k_0 = 1: zonal coefficients (zonal.h) of the kernel that the window convolves with. Hann
/// and Lanczos as in Sloan 2008, "Stupid Spherical Harmonics (SH) Tricks", section on windowing.
///
/// The last two are kernels K(t) >= 0 for all t with unit mass, so that what is not negative stays so, no maximum is
/// exceeded, and no light is gained: they are what makes an iteration through light maps contract. A polynomial that is
/// nowhere negative on [-1, 1] and of degree 2n-2 has its mean of t at most at the largest root x of P_n (its mean is
/// exactly the n-point Gauss quadrature's); that is reached by K = c (P_n(t) / (t - x))^2 alone. `non_negative` is this
/// kernel, and for an odd degree 2n-1 likewise (1+t) times such a square. For 7 bands its k_1 is 0.861, the squared
/// Dirichlet kernel's 0.75.
std::vector<double> window_factors(Window window, int bands);

std::string_view window_name(Window window);
/// "none", "hann", "lanczos", "non-negative", "squared-dirichlet"; throws InputError that lists them.
Window window_from_name(std::string_view name);

} // namespace kokage

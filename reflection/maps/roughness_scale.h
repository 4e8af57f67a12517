#pragma once
// How rough a surface is, in each of the words that users have for it: smoothness λ (the radius in the paper's cube),
// Phong's exponent Λ, glTF's roughness.
#include "reflection/maps/lobe.h"

namespace kokage {

/// A part of the scale, in smoothness λ: 0 <= roughest <= smoothest <= 1.
struct SmoothnessRange {
    double roughest = 0, smoothest = 1;
};

/// A part of the scale, in glTF's roughness: 0 (a mirror) <= smoothest <= roughest <= 1.
struct RoughnessRange {
    double smoothest = 0, roughest = 1;
};

/// [R] eqs 12 and 13: Λ = g(λ) = -ln I / ln cos(arctan(u / (λ s))), evaluated as 2 ln I / log1p((u/(λ s))²).
/// s = cube size in voxels, I = brightness levels; g(1) = Λ_max fixes u.
class RoughnessScale {
  public:
    /// u solved from (s, I, Λ_max).
    static RoughnessScale solved(int cube_size, double levels = 256, double most_exponent = 5000);
    /// u as the paper prints it: 6.2.
    static RoughnessScale as_printed(int cube_size, double levels = 256);
    /// u as given: that of a map that was stored.
    static RoughnessScale with_u(double u, int cube_size, double levels);

    double exponent(double smoothness) const; ///< g(λ), λ in (0,1]; 0 at λ = 0
    double smoothness(double exponent) const; ///< its inverse
    double u() const { return u_; }
    double levels() const { return levels_; }
    int cube_size() const { return cube_size_; }

  private:
    RoughnessScale(double u, double levels, int cube_size);
    double u_, levels_;
    int cube_size_;
};

/// Phong's exponent whose lobe filters images most like GGX's at glTF's roughness: Λ = (0.305 + 0.695 α^1.24)/α² with α
/// = roughness² (the rule and its error, 0 to 8 % of the filtered image's variation, are in the .cpp). 1 at roughness
/// 1, infinite at 0.
double exponent_from_roughness(double gltf_roughness);
/// Its inverse; exponents of 1 and less are roughness 1. λ of a glTF roughness is
/// scale.smoothness(exponent_from_roughness(roughness)).
double roughness_from_exponent(double exponent);

} // namespace kokage

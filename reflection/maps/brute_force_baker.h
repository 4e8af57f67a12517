#pragma once
// The truth that the other bakers are held against: [R] eqs 8 and 9, for any lobe.
#include "reflection/maps/baker.h"
#include "reflection/maps/lat_long_sums.h"

namespace kokage {

/// F(t) = Σ_ω Ω(ω) w(t,ω) / Σ_ω w(t,ω), w = lobe(|t-ω|²) dω, over every pixel's centre ω with its exact solid angle dω,
/// in double. A pixel whose weight is below 1e-17 of the lobe's peak is left out. Where the image is so coarse beside
/// the lobe that all pixels are, weights are taken relative to the nearest pixel's, which is their limit; where all of
/// them are beyond the lobe's right angle, the nearest pixel's radiance is taken. Distant lights are added with the
/// lobe's exact integral over their discs (lobe_over_cone.h). Cost: about 2.5 ns a pixel of the hemisphere a texel.
std::unique_ptr<Baker> brute_force_baker(const TexelLayout& layout, int image_width, int image_height);

/// One texel of it, pixel by pixel with nothing left out: the obvious twin.
glm::dvec3 filtered_by_brute_force(const Environment& surroundings, const Lobe& lobe, const glm::dvec3& direction);

/// The image's part of a texel, by vectors; pixels whose weight is below `least_share` of the lobe's peak are left out.
glm::dvec3 filtered_image(const LatLongPlanes& planes, const Lobe& lobe, const glm::dvec3& direction,
                          double least_share);

} // namespace kokage

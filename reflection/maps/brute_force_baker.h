#pragma once
// The truth that the other bakers are held against: [R] eqs 8 and 9, for any lobe.
#include "reflection/maps/baker.h"

namespace kokage {

/// F(t) = Σ_ω Ω(ω) w(t,ω) / Σ_ω w(t,ω), w = lobe(|t-ω|²) dω, over every pixel's centre ω with its exact solid angle dω,
/// in double. A pixel whose weight is below 1e-17 of the lobe's peak is left out.
std::unique_ptr<Baker> brute_force_baker(const TexelLayout& layout, int image_width, int image_height);

/// One texel of it.
glm::dvec3 filtered_by_brute_force(const Environment& surroundings, const Lobe& lobe, const glm::dvec3& direction);

} // namespace kokage

#pragma once
// Light from the ends of lines: sums over directions of projected area x open share x radiance, for every facet.
#include "foliage/bundles/bundle_tracing.h"

#include <span>

namespace kokage::bundles {

/// Weighted sums of one facet over directions.
///
/// weight = projected share of the facet's area (|n.d| for a leaf), over the chance that a line met it at all. A facet
/// that covers few pixels is not always met, so that steep directions would be missing from the sums otherwise
/// (down-facing sides would see a sixth too little of the sky above the horizon); what was met stands for what was not.
/// That chance is min(x, 1) for a solid facet that covers x pixels. Pixels of needles and scales in a mask don't hang
/// together so: 1 - exp(-x) would be the chance if they fell independently. It is 1 - exp(-(x + c x^2)) within 0.02 for
/// all x, with c = 0.22 on grown pines, spruces and cypresses, 0.4 on cards with leaves, 0.5 on whole ones; 0.3 is
/// within 0.04 of all of these. (min(x, 1) is wrong by up to 0.27, and pines are then 1 % too dark.)
inline constexpr float kNeedleClumping = 0.3f;
struct EndSums {
    float weight = 0;                                ///< of the directions whose lines met the facet
    float front_open = 0, back_open = 0;             ///< weight x open share
    float front_down = 0, back_down = 0;             ///< of it, towards the lower hemisphere (far ends)
    float front[3] = {0, 0, 0}, back[3] = {0, 0, 0}; ///< weight x open share x radiance
};

/// Adds directions [first, last) of a set of lines to the sums of all facets.
void gather_ends(const Facets& facets, std::span<const glm::vec3> directions, const OpenFractions& open,
                 const EndRadiance& radiance, std::size_t first, std::size_t last, std::span<EndSums> sums);

} // namespace kokage::bundles

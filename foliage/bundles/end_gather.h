#pragma once
// Light from the ends of lines: sums over directions of projected area x open share x radiance, for every facet.
#include "foliage/bundles/bundle_tracing.h"

#include <span>

namespace kokage::bundles {

/// Weighted sums of one facet over directions.
///
/// weight = projected share of the facet's area (|n.d| for a leaf), over the chance that a line met it at all. A facet
/// that covers less than a pixel is met by a line with a chance of its pixels, so that steep directions would be
/// missing from the sums otherwise (down-facing sides would see a sixth too little of the sky above the horizon); what
/// was met stands for what was not.
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

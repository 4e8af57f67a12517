#pragma once
// Bark ages with the wood: twigs, limbs and the foot of the trunk look different.
#include "trees/growth/bark.h"

#include <vector>

namespace kokage {

/// How a zone's bark looks.
struct BarkZone {
    bool is_twig = false; ///< young bark: one plain colour
    float age = 0;        ///< as in bark_image(); no twigs
    bool operator==(const BarkZone&) const = default;
};

/// The zone of a patch: twigs are thinner than 12 mm and than a sixth of the trunk; a birch's, an aspen's and a
/// pine's trunk is old at its foot and young above, in up to seven ages; on other trees all wood beyond twigs looks
/// alike.
BarkZone bark_zone(const BarkPlace& place, const GrowthParameters& parameters, float trunk_radius_m,
                   float tree_height_m, std::uint32_t patch);

/// Cuts bark, whole patches at a time, into one part for each zone that occurs, and gives their zones. The first part
/// is that of the trunk's foot. Patch numbers, vertices' values and the order of triangles stay as they are.
struct BarkInZones {
    std::vector<TreePart> parts;
    std::vector<BarkZone> zones; ///< of the parts
};
BarkInZones split_by_zone(const TreePart& bark, const std::vector<BarkPlace>& places,
                          const GrowthParameters& parameters);

} // namespace kokage

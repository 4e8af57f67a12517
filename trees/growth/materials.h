#pragma once
// How the grown tree's surfaces look.
#include "trees/growth/bark_zones.h"
#include "trees/growth/parameters.h"
#include "trees/tree.h"

namespace kokage {

/// Leaf material: reflectance and transmittance of the species in the season, veins in a small texture; alpha for
/// cards.
TreeMaterial leaf_material(const GrowthParameters& parameters);
/// Bark material of one zone: its colour in a texture that tiles, its roughness.
TreeMaterial bark_material(const GrowthParameters& parameters, const BarkZone& zone);

} // namespace kokage

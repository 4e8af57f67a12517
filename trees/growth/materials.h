#pragma once
// How the grown tree's surfaces look.
#include "trees/growth/parameters.h"
#include "trees/tree.h"

namespace kokage {

/// Leaf material: measured-like reflectance and transmittance, veins in a small texture; alpha for cards.
TreeMaterial leaf_material(const GrowthParameters& parameters);
/// Bark material: grey-brown, with fissures in a texture that tiles.
TreeMaterial bark_material(const GrowthParameters& parameters);

} // namespace kokage

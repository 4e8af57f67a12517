#pragma once
// How much light leaves reflect and let through, by species and season.
#include "trees/growth/parameters.h"

namespace kokage {

/// Means over a leaf in linear Rec.709; reflectance + transmittance <= 1 in every channel.
struct LeafOptics {
    glm::vec3 reflectance, transmittance;
};

/// Of a leaf of this species in this season (the leaves that hang in winter: those of conifers; for other trees
/// autumn's).
LeafOptics leaf_optics(LeafKind kind, Season season);

} // namespace kokage

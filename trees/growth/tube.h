#pragma once
// One branch as a generalised cylinder: rings of vertices along a smoothed centre line.
#include "trees/growth/parameters.h"
#include "trees/tree.h"

#include <vector>

namespace kokage {

struct Ring {
    glm::vec3 centre, along, x, y; ///< frame: along is the direction of the branch
    float radius_m = 0;
    float from_start_m = 0; ///< length of the centre line up to here
    int sides = 3;          ///< vertices of this ring
};

/// parent_radius: of the parent where the branch leaves it; 0 for a trunk.
/// Places rings where the centre line bends or the radius changes; fewer sides on thinner wood. The last ring is the
/// tip (radius 0).
std::vector<Ring> place_rings(const Branch& branch, float parent_radius, const GrowthParameters& parameters);

} // namespace kokage

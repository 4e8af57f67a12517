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
    bool on_parent = false; ///< its vertices are slid along the branch on to the parent's surface
};

/// Where a branch leaves its parent's tube; radius 0 for a trunk.
struct Joint {
    glm::vec3 centre{0.f}, axis{0, 1, 0}; ///< a point and the direction of the parent's centre line
    float radius_m = 0;                   ///< of the parent there
};

struct Tube {
    Joint joint;
    std::vector<Ring> rings; ///< at least 2; the last one is the tip (radius 0)
};

/// The tubes of all branches: rings where the centre line bends or the radius changes, fewer sides on thinner wood.
/// Thick branches get a collar: a narrow foot inside the parent, a wide ring on its surface, and two that narrow to the
/// branch.
std::vector<Tube> make_tubes(const Skeleton& skeleton, const GrowthParameters& parameters);

/// Moves every node to the nearest place on its tube's centre line, which is smoother than the skeleton, so that
/// branching points lie where the bark has them. What was one place stays one.
void move_to_centre_lines(Skeleton& skeleton, const std::vector<Tube>& tubes);

} // namespace kokage

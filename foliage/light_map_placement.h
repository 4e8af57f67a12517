#pragma once
// Where light-environment maps stand ([F] section 2, fig 2): at the branching points of generations 1, n-1 and n.
#include "trees/tree.h"

#include <cstddef>
#include <string>
#include <vector>

namespace kokage {

/// A branching point that gets a light-environment map, and the foliage cluster that it bears.
struct LightMapPlace {
    glm::vec3 position{0.f}; ///< the branching point, relative to Tree::origin
    float radius_m =
        0; ///< of the cluster's sphere: 95th percentile of the distances to its leaf centres; 0 if it bears none
    float clearance_m = 0;    ///< radius of the wood around the branching point: capture rays start this far out
    int generation = 0;       ///< order of the branch that starts here
    std::int32_t branch = -1; ///< that branch; -1 when the place was not taken from the skeleton
};

struct LightMapPlacement {
    std::vector<LightMapPlace>
        places;                 ///< in the order in which they were picked: a prefix is the placement for fewer maps
    std::size_t candidates = 0; ///< branching points of generations 1, n-1 and n
    int last_generation = 0;    ///< n, the last order that bears leaves
    std::string note;           ///< one line for reports when something had to be substituted; else empty
};

/// Picks up to `count` places among the branching points of generations 1, n-1 and n by farthest-point sampling: the
/// first is the lowest point of generation 1, each next one is the farthest from all before it; ties go to the lower
/// branch index. Picking ends early when only copies of picked points are left. [F] says neither how many maps there
/// are, nor how they are chosen, nor the spheres' radius: this is our reading (README). A tree without such branching
/// points gets one map, at the centre of its leaves (else of its wood); a tree of nothing gets none. Throws InputError
/// if count < 1.
LightMapPlacement place_light_maps(const Tree& tree, int count);

/// Nearest-rank percentile: the smallest value that at least `share` of all values do not exceed; 0 if there are none.
float percentile(std::vector<float> values, double share);

} // namespace kokage

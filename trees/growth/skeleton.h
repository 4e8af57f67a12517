#pragma once
// From wood in steps to branches with generations, radii and leaf-bearing shoots.
#include "trees/growth/wood_graph.h"
#include "trees/tree.h"

#include <vector>

namespace kokage {

/// A twig of this year: a branch, or the end of one, that bears leaves.
struct Shoot {
    std::int32_t branch = -1;
    std::uint32_t first_node = 0; ///< in its branch: where the shoot begins; it goes on to the branch's last node
    std::uint32_t first_leaf = 0, leaf_count = 0;
};

struct GrownSkeleton {
    Skeleton skeleton;
    std::vector<Shoot> shoots;
};

/// Mean number of leaves on a shoot in a tree of this height: hanging shoots are as long as the tree asks for, and bear
/// more.
double leaves_on_a_shoot(const GrowthParameters& parameters, double height_m);

/// Puts shoots on the ends of the wood that get enough light to live, shares `parameters.leaves` out among them, drops
/// wood that bears none, lets thin wood sag, and reads the rest as branches: where wood forks, the part that bears most
/// goes on as the same branch, the others are branches of the next order. Radii follow the pipe model (Shinozaki et al.
/// 1964): radius^e = sum over what it bears, e = pipe_exponent.
GrownSkeleton make_skeleton(std::vector<WoodNode> nodes, const SkyLight& light, double height_m,
                            const GrowthParameters& parameters);

} // namespace kokage

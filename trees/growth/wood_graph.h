#pragma once
// Wood as a tree of small steps, before it is read as branches.
#include "common/services/progress.h"
#include "trees/growth/crown.h"
#include "trees/growth/parameters.h"
#include "trees/growth/sky_light.h"

#include <vector>

namespace kokage {

struct WoodNode {
    glm::vec3 position;
    std::int32_t parent = -1; ///< parents come before their children; -1 for the foot of the trunk
    std::int32_t axis = -1;   ///< trunk 0, main limbs 1, 2, ...; -1 for what grew by itself
    bool may_branch = true;   ///< false on the clean bole and the inner part of limbs
};

/// Trunk and main limbs, in steps, and the courses that the limbs were to take.
struct Scaffold {
    std::vector<WoodNode> nodes;
    std::vector<Limb> limbs;
};

/// Trunk and main limbs in steps of about step_m: whorls, divergence, bends, knees, as far as the crown's outline.
Scaffold grow_scaffold(const GrowthParameters& parameters, const Crown& crown, float step_m);

/// How far things reach while the crown is filled, in metres.
struct ColonisationScale {
    float step, influence, kill;
};

/// Space colonisation (Runions, Lane and Prusinkiewicz 2007) by buds (Palubicki et al. 2009): every attraction point
/// pulls the node nearest to it within reach; pulled nodes grow a step towards the mean of their pulls; points closer
/// to wood than `kill` are used up. So branches share out space (and light) among themselves. Where a node bears a
/// second branch, that leaves at the species' branching angle; apical dominance holds it back and keeps axes straight;
/// gravity and light bend the course. Appends to `nodes`.
void colonise(std::vector<WoodNode>& nodes, const std::vector<glm::vec3>& points, const SkyLight& light,
              const GrowthParameters& parameters, const ColonisationScale& scale, Progress& progress);

} // namespace kokage

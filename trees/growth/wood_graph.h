#pragma once
// Wood as a tree of small steps, before it is read as branches.
#include "common/services/progress.h"
#include "trees/growth/crown.h"
#include "trees/growth/parameters.h"

#include <vector>

namespace kokage {

struct WoodNode {
    glm::vec3 position;
    std::int32_t parent = -1; ///< parents come before their children; -1 for the foot of the trunk
    std::int32_t axis = -1;   ///< trunk 0, main limbs 1, 2, ...; -1 for what grew by itself
    bool may_branch = true;   ///< false on the clean bole and the inner part of limbs
};

/// Trunk and main limbs, in steps of about step_m: knees, wandering, course towards the crown's outline.
std::vector<WoodNode> grow_scaffold(const GrowthParameters& parameters, const Crown& crown, float step_m);

/// Space colonisation (Runions, Lane and Prusinkiewicz 2007): every attraction point pulls the node nearest to it,
/// within influence_m; pulled nodes grow a step towards the mean of their pulls; points closer than kill_m to wood are
/// used up. So branches share out space (and light) among themselves. Appends to `nodes`.
void colonise(std::vector<WoodNode>& nodes, const Crown::Attractors& attractors, const GrowthParameters& parameters,
              float step_m, float influence_m, float kill_m, Progress& progress);

} // namespace kokage

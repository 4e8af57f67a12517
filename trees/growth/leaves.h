#pragma once
// Leaves on shoots.
#include "trees/growth/skeleton.h"

namespace kokage {

/// All leaves as one foliage part (uvs as in LeafShape), and their centres; none if the tree is bare (is_bare).
/// `crown_centre` is what leaves turn away from.
void make_leaves(const GrownSkeleton& skeleton, const GrowthParameters& parameters, const glm::vec3& crown_centre,
                 TreePart& part, std::vector<Leaf>& leaves);

/// Azimuth around the shoot of its j-th leaf, in radians from some start, as its arrangement has it.
float leaf_azimuth(LeafArrangement arrangement, std::uint32_t j);
/// Which node of the shoot it stands at, counted from the shoot's foot: opposite and whorled leaves share theirs.
std::uint32_t leaf_node(LeafArrangement arrangement, std::uint32_t j);

} // namespace kokage

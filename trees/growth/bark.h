#pragma once
// Skeleton -> bark.
#include "trees/growth/parameters.h"
#include "trees/tree.h"

namespace kokage {

/// One generalised cylinder a branch, in parallel-transport frames, closed at both ends: its foot lies inside the
/// parent, with a collar that widens towards it; the trunk flares into roots at the ground. OpenMesh builds each tube,
/// tells whether it is a closed manifold and gives its normals. uvs: u counts a whole number of texture tiles around
/// the branch, v runs along it at the same scale, so that the texture is not stretched. Returns the number of bark
/// patches; appends to the part.
std::uint32_t make_bark(const Skeleton& skeleton, const GrowthParameters& parameters, TreePart& part);

} // namespace kokage

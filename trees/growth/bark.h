#pragma once
// Tubes -> bark.
#include "trees/growth/tube.h"

namespace kokage {

/// Where a bark patch lies on the tree.
struct BarkPlace {
    float radius_m = 0; ///< of the wood
    float height_m = 0;
    bool on_trunk = false;
    std::uint32_t branch = 0; ///< in the skeleton
};

/// One generalised cylinder a branch, in parallel-transport frames, closed at both ends: its foot lies inside the
/// parent, with a collar that widens towards it; the trunk flares into roots at the ground. OpenMesh builds each tube,
/// tells whether it is a closed manifold and gives its normals. uvs: u counts a whole number of texture tiles around
/// the branch, v runs along it at the same scale, so that the texture is not stretched. Returns the number of bark
/// patches; appends to the part, and to `places` (where it is given) each patch's place.
std::uint32_t make_bark(const std::vector<Tube>& tubes, const GrowthParameters& parameters, TreePart& part,
                        std::vector<BarkPlace>* places = nullptr);

} // namespace kokage

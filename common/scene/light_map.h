#pragma once
#include "common/types.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

/// A light-environment map [F]: the light that arrives at a point from every direction, as real SH coefficients (eq 1).
struct LightMap {
    glm::vec3 position{0.f}; ///< the branching point
    float radius_m = 0;      ///< the sphere of the foliage cluster that it bears (95th percentile of leaf distances)
    int generation = 0;      ///< of its branching point; the trunk's order is 0
    int bands = 7;
    std::vector<glm::vec3> coefficients; ///< bands^2, index l(l+1)+m
};

/// One map that a patch reads, with its share.
struct LightMapShare {
    std::uint32_t map = 0;
    float share = 0;
};

/// Light maps as the patches of a scene read them: the light about a patch is the mixture of a few. A patch's shares
/// add up to 1, or are all 0: it reads none.
struct LightMapsOfPatches {
    std::vector<LightMap> maps; ///< all of as many bands
    std::size_t per_patch = 0;
    std::vector<LightMapShare> shares; ///< per_patch of each patch in turn

    bool empty() const { return maps.empty(); }
    std::span<const LightMapShare> of(std::size_t patch) const {
        return {shares.data() + patch * per_patch, per_patch};
    }
};

} // namespace kokage

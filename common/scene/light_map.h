#pragma once
#include "common/types.h"

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

} // namespace kokage

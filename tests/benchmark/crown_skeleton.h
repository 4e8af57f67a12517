#pragma once
#include "trees/tree.h"

namespace kokage {

/// The golden angle's cosine and sine: successive limbs and leaves turn by it, as those of real trees do.
inline constexpr double kGoldenCos = -0.73736887807831979, kGoldenSin = 0.67549029426152362;

/// Where the crown of the benchmark ends: a dome, in metres.
struct CrownEnvelope {
    glm::dvec3 centre{0.0, 6.6, 0.0};
    double half_width = 4.4, half_height_up = 5.2, half_height_down = 3.4;

    /// 0 at the centre, 1 on the surface.
    double level(const glm::dvec3& point) const;
    /// The point of the surface in a direction (not 0) from the centre.
    glm::dvec3 surface(const glm::dvec3& direction) const;
};

/// Trunk, limbs, branches and `twigs` twigs, which are the branches of the highest order and the last ones in the list.
/// Orders 0 to 2 have the same shape for every number of twigs; orders 3 and 4 share out the rest.
/// Radii follow the pipe model: a cross-section is the sum of those it feeds.
Skeleton make_bench_skeleton(std::uint32_t twigs, std::uint64_t seed);

} // namespace kokage

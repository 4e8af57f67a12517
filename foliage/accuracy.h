#pragma once
// Error figures of a shading against a reference, as every figure in this project is meant.
#include "common/scene/patch_scene.h"
#include "foliage/solution.h"

namespace kokage {

struct Accuracy {
    double mre = 0; ///< mean over leaves, sides and channels of |x - ref| / max(ref, 0.05 mean ref of that channel)
    double p95 = 0; ///< 95th percentile of the same
    double rmse_over_mean = 0; ///< RMSE / mean ref
    double bias = 0;           ///< sum of area (x - ref) / sum of area ref
};

/// Mean radiance of each leaf side: patches of a leaf averaged by area. Result: 2 x leaf_count, front and back of leaf
/// 0, of leaf 1, ...
std::vector<glm::vec3> leaf_side_radiance(const PatchScene& scene, const SideRadiance& radiance);

/// `areas`: solid area of each leaf. Sizes must agree.
Accuracy accuracy(const std::vector<glm::vec3>& sides, const std::vector<glm::vec3>& reference,
                  const std::vector<double>& leaf_areas);

} // namespace kokage

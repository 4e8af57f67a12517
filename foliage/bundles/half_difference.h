#pragma once
// The error of a mean, seen from the two halves that it is the mean of.
#include "common/scene/patch_scene.h"
#include "foliage/bundles/bounce_sweeps.h"

namespace kokage::bundles {

/// leaf_side_radiance() of values per side.
std::vector<glm::vec3> leaf_sides(const PatchScene& scene, const std::vector<Rgb>& sides);

/// Estimated MRE (foliage/accuracy.h) of the mean of two estimates. `half_differences`: half of what they differ by,
/// per side. It has the same distribution as the error of their mean when they are independent and alike. Halves of
/// evenly spread lines are not quite: measured, it comes out right all the same (foliage/README.md).
double half_difference_error(const PatchScene& scene, const std::vector<Rgb>& mean,
                             const std::vector<Rgb>& half_differences);

} // namespace kokage::bundles

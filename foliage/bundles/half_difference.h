#pragma once
// The error of a mean, seen from the two independent halves that it is the mean of.
#include "common/scene/patch_scene.h"
#include "foliage/bundles/bounce_sweeps.h"

namespace kokage::bundles {

/// Estimated MRE (DESIGN 3) of (a + b) / 2. Half the difference of two independent, equally distributed estimates has
/// the same distribution as the error of their mean, so nothing needs calibrating.
double half_difference_error(const PatchScene& scene, const std::vector<Rgb>& a, const std::vector<Rgb>& b);

} // namespace kokage::bundles

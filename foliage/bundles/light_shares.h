#pragma once
// How light is shared out among the lights and the parts of the sky: what tells whether a measured error still stands.
#include "common/environment/environment.h"

#include <vector>

namespace kokage::bundles {

/// Shares of the irradiance that a surface which faces its source receives, each channel's sum 1 (0 where there is no
/// light): of every light in the order of the environment, distant ones first, then of the cells of the remainder, 8 x
/// 4 of a lat-long image. Point lights as at `centre`. `above_horizon`: the lower half of the remainder does not count
/// (a ground hides it).
std::vector<glm::vec3> light_shares(const Environment& environment, const glm::vec3& centre, bool above_horizon);

/// The share of light that comes from elsewhere: half the sum of differences, in the channel where it is largest; 1 if
/// the lists are not equally long.
double moved_light(const std::vector<glm::vec3>& before, const std::vector<glm::vec3>& now);

} // namespace kokage::bundles

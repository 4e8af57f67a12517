#pragma once
// Split-off lights as beams: each distant light becomes a few directions, drawn at high resolution.
#include "common/environment/environment.h"

#include <cstdint>
#include <vector>

namespace kokage::bundles {

/// A direction of a light with its share of the light's irradiance. Even beams belong to one half, odd beams to the
/// other; each half carries the whole light on its own (irradiance is given so that the mean of both halves is right).
struct Beam {
    glm::vec3 direction_to_light;
    glm::vec3 irradiance; ///< on a facing surface
};

/// Beams of one light: stratified over its disc or texels. `count` is rounded up to an even number.
std::vector<Beam> make_beams(const DistantLight& light, int count, std::uint64_t seed);

} // namespace kokage::bundles

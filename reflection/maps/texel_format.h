#pragma once
// How texels are kept in memory and given to a GPU.
#include "common/types.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace kokage {

enum class TexelFormat {
    half_rgb,        ///< 6 bytes, R G B as IEEE halves (GL_RGB16F): relative error <= 2^-11, largest value 65504
    float_rgb,       ///< 12 bytes (GL_RGB32F)
    shared_exponent, ///< 4 bytes (GL_RGB9_E5): error <= 2^-9 of the largest channel, largest value 65408
};
std::string_view texel_format_name(TexelFormat format); ///< "half", "float", "shared-exponent"
/// Throws InputError that lists them.
TexelFormat texel_format_from_name(std::string_view name);
std::size_t texel_bytes(TexelFormat format);
/// Largest error of rounding to it, as a share of the value (shared exponent: of the largest channel); 0 for floats.
double format_rounding(TexelFormat format);

/// Finite colours in a format's bytes, rounded to the nearest; what is larger than the format can hold becomes its
/// largest value, and negative values become 0 in a shared exponent.
std::vector<std::byte> packed_texels(std::span<const glm::vec3> texels, TexelFormat format);
glm::vec3 unpacked_texel(const std::byte* texel, TexelFormat format);

} // namespace kokage

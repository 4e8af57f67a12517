#include "reflection/maps/texel_format.h"

#include "common/services/error.h"
#include "common/services/parallel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

namespace kokage {
namespace {

constexpr float kLargestHalf = 65504, kLargestShared = 65408;

/// Round to nearest, ties to even; finite, at most kLargestHalf.
std::uint16_t half_from_float(float value) {
    const std::uint32_t bits = std::bit_cast<std::uint32_t>(value), sign = (bits >> 16) & 0x8000u;
    std::uint32_t magnitude = bits & 0x7fffffffu;
    if (magnitude < 0x38800000u) { // below 2^-14: a denormal, a multiple of 2^-24
        const float steps = std::nearbyint(std::bit_cast<float>(magnitude) * 0x1p24f);
        return std::uint16_t(sign | std::uint32_t(steps));
    }
    magnitude += 0xfffu + ((magnitude >> 13) & 1u); // half a unit of the last place that stays
    return std::uint16_t(sign | ((magnitude - 0x38000000u) >> 13));
}

float float_from_half(std::uint16_t half) {
    const std::uint32_t sign = std::uint32_t(half & 0x8000u) << 16, magnitude = half & 0x7fffu;
    if (magnitude < 0x400u)
        return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(float(magnitude) * 0x1p-24f));
    return std::bit_cast<float>(sign | ((magnitude << 13) + 0x38000000u));
}

/// OpenGL 4.6, 8.5.2 "Encoding of Special Internal Formats": 9 bits a mantissa, exponent of 5 bits, bias 15.
std::uint32_t shared_from_colour(const glm::vec3& colour) {
    const glm::vec3 c = glm::clamp(colour, 0.f, kLargestShared);
    const float largest = std::max({c.r, c.g, c.b});
    int exponent = std::max(-16, largest > 0 ? std::ilogb(largest) : -16) + 16;
    const auto step = [&] { return std::ldexp(1.f, exponent - 15 - 9); };
    if (std::floor(largest / step() + 0.5f) >= 512)
        ++exponent;
    const auto mantissa = [&](float value) { return std::uint32_t(std::floor(value / step() + 0.5f)); };
    return mantissa(c.r) | mantissa(c.g) << 9 | mantissa(c.b) << 18 | std::uint32_t(exponent) << 27;
}

glm::vec3 colour_from_shared(std::uint32_t bits) {
    const float step = std::bit_cast<float>(((bits >> 27) + (127 - 24)) << 23);
    return step * glm::vec3(float(bits & 511u), float(bits >> 9 & 511u), float(bits >> 18 & 511u));
}

void pack(const glm::vec3& colour, TexelFormat format, std::byte* to) {
    if (format == TexelFormat::float_rgb) {
        std::memcpy(to, &colour, 12);
    } else if (format == TexelFormat::half_rgb) {
        const glm::vec3 c = glm::clamp(colour, -kLargestHalf, kLargestHalf);
        const std::uint16_t halves[3] = {half_from_float(c.r), half_from_float(c.g), half_from_float(c.b)};
        std::memcpy(to, halves, 6);
    } else {
        const std::uint32_t bits = shared_from_colour(colour);
        std::memcpy(to, &bits, 4);
    }
}

} // namespace

std::string_view texel_format_name(TexelFormat format) {
    return format == TexelFormat::half_rgb ? "half" : format == TexelFormat::float_rgb ? "float" : "shared-exponent";
}

TexelFormat texel_format_from_name(std::string_view name) {
    for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb, TexelFormat::shared_exponent})
        if (name == texel_format_name(format))
            return format;
    throw InputError("texel format '" + std::string(name) + "': there are half, float and shared-exponent");
}

std::size_t texel_bytes(TexelFormat format) {
    return format == TexelFormat::half_rgb ? 6 : format == TexelFormat::float_rgb ? 12 : 4;
}

std::vector<std::byte> packed_texels(std::span<const glm::vec3> texels, TexelFormat format) {
    const std::size_t each = texel_bytes(format);
    std::vector<std::byte> bytes(texels.size() * each);
    parallel_blocks(texels.size(), 8192, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            pack(texels[i], format, bytes.data() + i * each);
    });
    return bytes;
}

glm::vec3 unpacked_texel(const std::byte* texel, TexelFormat format) {
    if (format == TexelFormat::float_rgb) {
        glm::vec3 colour;
        std::memcpy(&colour, texel, 12);
        return colour;
    }
    if (format == TexelFormat::half_rgb) {
        std::uint16_t halves[3];
        std::memcpy(halves, texel, 6);
        return {float_from_half(halves[0]), float_from_half(halves[1]), float_from_half(halves[2])};
    }
    std::uint32_t bits;
    std::memcpy(&bits, texel, 4);
    return colour_from_shared(bits);
}

} // namespace kokage

#include "reflection/maps/texel_format.h"

#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/maps/texel_codes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

namespace kokage {
namespace {

void pack(const glm::vec3& colour, TexelFormat format, std::byte* to) {
    if (format == TexelFormat::float_rgb) {
        std::memcpy(to, &colour, 12);
    } else {
        const std::uint32_t bits = shared_exponent_from_rgb(colour);
        std::memcpy(to, &bits, 4);
    }
}

/// One loop over all channels, which compilers do by vectors.
void pack_halves(std::span<const glm::vec3> texels, std::byte* to) {
    constexpr std::size_t kRun = 512; // texels
    std::array<std::uint16_t, 3 * kRun> halves;
    for (std::size_t begin = 0; begin < texels.size(); begin += kRun) {
        const std::size_t count = 3 * std::min(kRun, texels.size() - begin);
        const float* from = &texels[begin].x;
        for (std::size_t i = 0; i < count; ++i)
            halves[i] = half_from_float(from[i]);
        std::memcpy(to + 6 * begin, halves.data(), 2 * count);
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

double format_rounding(TexelFormat format) {
    return format == TexelFormat::half_rgb    ? std::ldexp(1.0, -11)
           : format == TexelFormat::float_rgb ? 0
                                              : std::ldexp(1.0, -9);
}

std::vector<std::byte> packed_texels(std::span<const glm::vec3> texels, TexelFormat format) {
    const std::size_t each = texel_bytes(format);
    std::vector<std::byte> bytes(texels.size() * each);
    parallel_blocks(texels.size(), 8192, [&](std::size_t begin, std::size_t end) {
        if (format == TexelFormat::half_rgb) {
            pack_halves(texels.subspan(begin, end - begin), bytes.data() + begin * each);
            return;
        }
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
    return rgb_from_shared_exponent(bits);
}

} // namespace kokage

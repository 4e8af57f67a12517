#include "reflection/maps/cube_texels.h"
#include "common/services/error.h"
#include "reflection/maps/texel_codes.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace kokage {
namespace {

constexpr std::size_t kBlock = 1024; ///< texels that are converted at a time, on the stack

bool all_within(std::span<const glm::vec3> texels, float least, float most) {
    bool within = true;
    for (const glm::vec3& t : texels)
        within &= t.r >= least && t.g >= least && t.b >= least && t.r <= most && t.g <= most && t.b <= most;
    return within;
}

void encode_halves(std::span<const glm::vec3> texels, unsigned char* to) {
    std::array<std::uint16_t, 3 * kBlock> halves;
    const float* from = &texels.front().x;
    for (std::size_t i = 0; i < 3 * texels.size(); ++i)
        halves[i] = half_from_float(from[i]);
    for (std::size_t i = 0; i < texels.size(); ++i) {
        const std::array<std::uint16_t, 4> rgba = {halves[3 * i], halves[3 * i + 1], halves[3 * i + 2], 0x3c00};
        std::memcpy(to + 8 * i, rgba.data(), 8);
    }
}

const char* face_name(std::size_t face) {
    return std::array{"+X", "-X", "+Y", "-Y", "+Z", "-Z"}[face];
}

} // namespace

std::size_t file_texel_bytes(TexelFormat format) {
    return format == TexelFormat::half_rgb ? 8 : format == TexelFormat::float_rgb ? 16 : 4;
}

std::size_t encode_texels(std::span<const glm::vec3> texels, TexelFormat format, unsigned char* to) {
    const float most = format == TexelFormat::half_rgb          ? kLargestHalf
                       : format == TexelFormat::shared_exponent ? kLargestSharedExponent
                                                                : std::numeric_limits<float>::max();
    const float least = format == TexelFormat::shared_exponent ? 0 : -most;
    const std::size_t each = file_texel_bytes(format);
    std::size_t clamped = 0;
    for (std::size_t begin = 0; begin < texels.size(); begin += kBlock) {
        const auto block = texels.subspan(begin, std::min(kBlock, texels.size() - begin));
        unsigned char* place = to + begin * each;
        if (!all_within(block, least, most))
            clamped += std::size_t(std::count_if(block.begin(), block.end(), [&](const glm::vec3& t) {
                return !all_within({&t, 1}, least, most);
            }));
        if (format == TexelFormat::half_rgb) {
            encode_halves(block, place);
            continue;
        }
        for (std::size_t i = 0; i < block.size(); ++i, place += each) {
            const glm::vec4 rgba(block[i], 1.f);
            const std::uint32_t shared = format == TexelFormat::float_rgb ? 0 : shared_exponent_from_rgb(block[i]);
            if (format == TexelFormat::float_rgb)
                std::memcpy(place, &rgba.x, 16);
            else
                std::memcpy(place, &shared, 4);
        }
    }
    return clamped;
}

void decode_texels(const unsigned char* from, TexelFormat format, std::span<glm::vec3> texels) {
    for (glm::vec3& texel : texels) {
        if (format == TexelFormat::float_rgb) {
            std::memcpy(&texel.x, from, 12);
        } else if (format == TexelFormat::half_rgb) {
            std::array<std::uint16_t, 3> halves;
            std::memcpy(halves.data(), from, 6);
            texel = {float_from_half(halves[0]), float_from_half(halves[1]), float_from_half(halves[2])};
        } else {
            std::uint32_t shared;
            std::memcpy(&shared, from, 4);
            texel = rgb_from_shared_exponent(shared);
        }
        from += file_texel_bytes(format);
    }
}

void check_finite(const PrefilteredCube& cube, const std::string& name) {
    constexpr float largest = std::numeric_limits<float>::max();
    for (std::size_t i = 0; i < cube.levels.size(); ++i) {
        const PrefilteredCube::Level& level = cube.levels[i];
        if (all_within(level.texels, -largest, largest))
            continue;
        for (std::size_t at = 0; at < level.texels.size(); ++at) {
            if (all_within({&level.texels[at], 1}, -largest, largest))
                continue;
            const std::size_t size = std::size_t(level.size), in_face = at % (size * size);
            throw InputError(name + ": level " + std::to_string(i) + ", face " + face_name(at / (size * size)) +
                             ", texel (" + std::to_string(in_face % size) + ", " + std::to_string(in_face / size) +
                             ") is not finite; bake the map again");
        }
    }
}

void check_levels(const PrefilteredCube& cube, const std::string& name) {
    if (cube.levels.empty())
        throw InputError(name + ": the cube map has no levels");
    for (std::size_t i = 0; i < cube.levels.size(); ++i) {
        const PrefilteredCube::Level& level = cube.levels[i];
        if (level.size < 1 || level.size != cube.levels[0].size >> i)
            throw InputError(name + ": level " + std::to_string(i) + " is " + std::to_string(level.size) +
                             " texels wide, not half as wide as the level before");
        if (level.texels.size() != 6 * std::size_t(level.size) * std::size_t(level.size))
            throw InputError(name + ": level " + std::to_string(i) + " has " + std::to_string(level.texels.size()) +
                             " texels, not 6 x " + std::to_string(level.size) + " x " + std::to_string(level.size));
    }
}

PrefilteredCube assumed_cube(int size, int levels) {
    PrefilteredCube cube;
    const std::vector<double> roughness = even_roughness(levels);
    for (int i = 0; i < levels; ++i) {
        PrefilteredCube::Level level;
        level.size = std::max(size >> i, 1);
        level.parameter = roughness[std::size_t(i)];
        level.unfiltered = i == 0;
        level.texels.resize(6 * std::size_t(level.size) * std::size_t(level.size));
        cube.levels.push_back(std::move(level));
    }
    return cube;
}

std::string parameter_text(const PrefilteredCube::Level& level) {
    if (level.unfiltered)
        return "image";
    std::array<char, 32> text;
    return std::string(text.data(), std::to_chars(text.data(), text.data() + text.size(), level.parameter).ptr);
}

void set_parameter(PrefilteredCube::Level& level, LobeKind kind, std::string_view text) {
    level.unfiltered = text == "image";
    if (level.unfiltered) {
        level.parameter = kind == LobeKind::ggx ? 0 : std::numeric_limits<double>::infinity();
        return;
    }
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), level.parameter);
    const double p = level.parameter;
    if (error != std::errc() || end != text.data() + text.size() ||
        !(kind == LobeKind::ggx ? p > 0 && p <= 1 : p >= 0 && p < 1e9))
        throw std::invalid_argument(std::string(text));
}

} // namespace kokage

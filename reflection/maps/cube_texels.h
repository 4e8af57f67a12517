#pragma once
// Texels of cube files: colours with an alpha of 1 to bytes and back. Inside of the maps' files alone.
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/texel_format.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

/// Bytes of a texel in a file: RGBA, or the shared exponent's 32 bits.
std::size_t file_texel_bytes(TexelFormat format);

/// `to` has texels.size() * file_texel_bytes(format) bytes. Gives how many texels had to be clamped.
std::size_t encode_texels(std::span<const glm::vec3> texels, TexelFormat format, unsigned char* to);
/// The other way; alpha is left out.
void decode_texels(const unsigned char* from, TexelFormat format, std::span<glm::vec3> texels);

/// Throws InputError "<name>: level 2, face -Y, texel (3, 4) is nan ..." for a value that is not finite.
void check_finite(const PrefilteredCube& cube, const std::string& name);

/// Throws InputError for a cube whose levels do not halve or whose texels are not as many as its levels say.
void check_levels(const PrefilteredCube& cube, const std::string& name);

/// Levels of `size`, size/2, ..., black, with even roughness: for files that do not say.
PrefilteredCube assumed_cube(int size, int levels);

/// "image", or the shortest text that reads back as the same number; and back. The latter throws std::invalid_argument
/// for anything else, and for what is no parameter of such a lobe.
std::string parameter_text(const PrefilteredCube::Level& level);
void set_parameter(PrefilteredCube::Level& level, LobeKind kind, std::string_view text);

/// Little-endian numbers, as both formats hold them.
class ByteWriter {
  public:
    std::vector<unsigned char> bytes;

    void u16(std::uint32_t value) { number(value, 2); }
    void u32(std::uint64_t value) { number(value, 4); }
    void u64(std::uint64_t value) { number(value, 8); }
    void u8(std::uint32_t value) { number(value, 1); }
    void text(std::string_view value) {
        for (const char c : value)
            u8(std::uint32_t(static_cast<unsigned char>(c)));
    }
    void align(std::size_t to) {
        while (bytes.size() % to != 0)
            bytes.push_back(0);
    }

  private:
    void number(std::uint64_t value, int count) {
        for (int i = 0; i < count; ++i)
            bytes.push_back(static_cast<unsigned char>(value >> (8 * i) & 255u));
    }
};

/// Reads past the end are the caller's fault: check sizes first.
inline std::uint64_t little_endian(std::span<const unsigned char> bytes, std::size_t at, int count) {
    std::uint64_t value = 0;
    for (int i = 0; i < count; ++i)
        value |= std::uint64_t(bytes[at + std::size_t(i)]) << (8 * i);
    return value;
}

} // namespace kokage

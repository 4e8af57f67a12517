#pragma once
// What the KTX 2.0 writer and reader share. Specification: https://registry.khronos.org/KTX/specs/2.0/ktxspec.v2.html
//
//     12  identifier            header: 9 numbers of 32 bits, then the index: offset and length of the format
//     36  header                descriptor (32 bits each), of the key/values (32), of supercompression data (64)
//     32  index
//     24  a level: offset, length, length before supercompression, level 0 first
//         data format descriptor, key/values
//         levels, the smallest first, each at a multiple of its texels' bytes and of 4: six faces, rows from the top
#include "reflection/maps/cube_texels.h"

#include <array>
#include <numeric>
#include <vector>

namespace kokage::ktx2 {

inline constexpr std::array<unsigned char, 12> kIdentifier = {0xab, 'K',  'T',  'X',  ' ',  '2',
                                                              '0',  0xbb, 0x0d, 0x0a, 0x1a, 0x0a};
inline constexpr std::size_t kHeaderBytes = 12 + 36 + 32, kLevelBytes = 24;

/// VkFormat and typeSize of a format.
struct Format {
    TexelFormat format;
    std::uint32_t vk_format, type_size;
};
inline constexpr std::array<Format, 3> kFormats = {
    {{TexelFormat::half_rgb, 97, 2}, {TexelFormat::float_rgb, 109, 4}, {TexelFormat::shared_exponent, 123, 4}}};

/// Levels begin at multiples of this.
inline std::size_t level_alignment(TexelFormat format) {
    return std::lcm(file_texel_bytes(format), std::size_t(4));
}

/// The whole data format descriptor, with its total size (Khronos Data Format 1.3, section 3.2 and the basic block of
/// chapter 4).
std::vector<unsigned char> data_format_descriptor(TexelFormat format);

/// The value of kokage.checksum: 16 hexadecimal digits, of all bytes from the first level's on and of what is said of
/// their lobes.
std::string checksum_text(std::string_view lobe, std::string_view parameters, std::span<const unsigned char> levels);

} // namespace kokage::ktx2

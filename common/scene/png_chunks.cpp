#include "common/scene/png_chunks.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string_view>

namespace kokage {
namespace {

constexpr std::array<unsigned char, 8> kSignatureBytes = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kSignature = kSignatureBytes.size(), kAroundData = 12; // length, type and checksum, 4 bytes each

constexpr std::array<std::uint32_t, 256> checksum_table() {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t value = byte;
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1) != 0 ? 0xedb88320u ^ value >> 1 : value >> 1;
        table[byte] = value;
    }
    return table;
}

/// CRC-32 (PNG specification, annex D).
std::uint32_t checksum(std::span<const std::byte> bytes) {
    static constexpr std::array<std::uint32_t, 256> table = checksum_table();
    std::uint32_t value = 0xffffffffu;
    for (const std::byte byte : bytes)
        value = table[(value ^ std::uint32_t(byte)) & 0xff] ^ value >> 8;
    return ~value;
}

std::uint32_t big_endian(std::span<const std::byte> bytes) {
    return std::uint32_t(bytes[0]) << 24 | std::uint32_t(bytes[1]) << 16 | std::uint32_t(bytes[2]) << 8 |
           std::uint32_t(bytes[3]);
}

bool is_essential(std::string_view type) {
    return type == "IHDR" || type == "PLTE" || type == "tRNS" || type == "IDAT" || type == "IEND";
}

/// What else the specification and its extensions name; pixels don't need it, nor its checksum to be right.
bool is_known_extra(std::string_view type) {
    constexpr std::array<std::string_view, 19> known = {"cHRM", "cICP", "gAMA", "iCCP", "mDCV", "cLLI", "sBIT",
                                                        "sRGB", "bKGD", "hIST", "eXIf", "pHYs", "sPLT", "tIME",
                                                        "iTXt", "tEXt", "zTXt", "acTL", "fcTL"};
    return type == "fdAT" || std::find(known.begin(), known.end(), type) != known.end();
}

} // namespace

std::vector<std::byte> essential_png_chunks(std::span<const std::byte> png, std::string& why) {
    const auto failed = [&](const char* what) {
        why = what;
        return std::vector<std::byte>();
    };
    if (png.size() < kSignature)
        return failed("it is cut off");
    if (std::memcmp(png.data(), kSignatureBytes.data(), kSignature) != 0)
        return failed("its header is damaged");
    std::vector<std::byte> kept(png.begin(), png.begin() + kSignature);
    kept.reserve(png.size());
    bool has_pixels = false;
    for (std::size_t at = kSignature; at < png.size();) {
        const std::span<const std::byte> rest = png.subspan(at);
        if (rest.size() < kAroundData || big_endian(rest) > rest.size() - kAroundData)
            return failed("it is cut off");
        const std::size_t length = big_endian(rest);
        const std::string_view type(reinterpret_cast<const char*>(rest.data()) + 4, 4);
        const std::span<const std::byte> chunk = rest.first(length + kAroundData);
        at += chunk.size();
        if (is_known_extra(type))
            continue;
        if (kept.size() == kSignature && (type != "IHDR" || length != 13))
            return failed("its header is damaged");
        if (checksum(chunk.subspan(4, length + 4)) != big_endian(chunk.last(4)))
            return failed(type == "IDAT" ? "its pixels are damaged" : "its header is damaged");
        if (!is_essential(type))
            continue;
        kept.insert(kept.end(), chunk.begin(), chunk.end());
        has_pixels = has_pixels || type == "IDAT";
        if (type == "IEND")
            return has_pixels ? kept : failed("it holds no pixels");
    }
    return failed("it is cut off");
}

} // namespace kokage

// DDS with a DX10 header ("Programming Guide for DDS", learn.microsoft.com): "DDS ", a header of 124 bytes, one of 20,
// then face after face, each with all its levels, the largest first.
#include "common/services/byte_hash.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "common/services/uninitialized_vector.h"
#include "reflection/maps/cube_file.h"
#include "reflection/maps/cube_texels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace kokage {
namespace {

// Names and values of Microsoft's headers.
enum : std::uint32_t {
    DDSD_CAPS = 0x1,
    DDSD_HEIGHT = 0x2,
    DDSD_WIDTH = 0x4,
    DDSD_PITCH = 0x8,
    DDSD_PIXELFORMAT = 0x1000,
    DDSD_MIPMAPCOUNT = 0x20000,
    DDPF_FOURCC = 0x4,
    DDSCAPS_COMPLEX = 0x8,
    DDSCAPS_TEXTURE = 0x1000,
    DDSCAPS_MIPMAP = 0x400000,
    DDSCAPS2_CUBEMAP_ALLFACES = 0xfe00,
    D3DFMT_A16B16G16R16F = 113,
    D3DFMT_A32B32G32R32F = 116,
    DXGI_FORMAT_R32G32B32A32_FLOAT = 2,
    DXGI_FORMAT_R16G16B16A16_FLOAT = 10,
    D3D10_RESOURCE_DIMENSION_TEXTURE2D = 3,
    D3D10_RESOURCE_MISC_TEXTURECUBE = 0x4,
};
constexpr std::uint32_t four_characters(const char (&text)[5]) {
    return std::uint32_t(text[0]) | std::uint32_t(text[1]) << 8 | std::uint32_t(text[2]) << 16 |
           std::uint32_t(text[3]) << 24;
}
constexpr std::size_t kHeaderBytes = 4 + 124, kDx10Bytes = 20, kNotes = 32, kMostLevels = kMostDdsLevels;
constexpr std::uint64_t kMostBytes = std::uint64_t(1) << 34, kLargestSize = 16384;

/// Of everything that follows the headers, and of what is said of the levels' lobes.
std::uint32_t notes_checksum(std::uint64_t lobe, std::span<const unsigned char> notes,
                             std::span<const unsigned char> texels) {
    return std::uint32_t(byte_hash(std::as_bytes(texels), byte_hash(std::as_bytes(notes), lobe)));
}

class DdsReader {
  public:
    DdsReader(std::string name, std::span<const unsigned char> bytes) : name_(std::move(name)), bytes_(bytes) {}

    CubeFile read() {
        read_header();
        CubeFile file;
        file.format = format_;
        file.cube = assumed_cube(int(size_), int(levels_));
        describe_lobes(file);
        std::size_t at = texels_at_;
        for (std::size_t face = 0; face < 6; ++face)
            for (PrefilteredCube::Level& level : file.cube.levels) {
                const std::size_t count = level.texels.size() / 6;
                decode_texels(bytes_.data() + at, format_, std::span(level.texels).subspan(face * count, count));
                at += count * file_texel_bytes(format_);
            }
        check_finite(file.cube, name_);
        return file;
    }

  private:
    [[noreturn]] void fail(const std::string& why) const { throw InputError(name_ + ": " + why); }
    std::uint64_t u32(std::size_t at) const { return little_endian(bytes_, at, 4); }

    void read_header() {
        if (bytes_.size() < 4 || u32(0) != four_characters("DDS "))
            fail("it is not a DDS file");
        if (bytes_.size() < kHeaderBytes)
            fail("it is cut off within its header");
        if (u32(4) != 124 || u32(76) != 32)
            fail("its header has other sizes than a DDS header's 124 and 32; it is damaged");
        const std::uint64_t code = u32(84);
        if ((u32(80) & DDPF_FOURCC) == 0)
            fail("its texels are not floating-point; half floats and floats can be read");
        texels_at_ = kHeaderBytes;
        std::uint64_t float_code = code;
        if (code == four_characters("DX10")) {
            texels_at_ += kDx10Bytes;
            if (bytes_.size() < texels_at_)
                fail("it is cut off within its DX10 header");
            float_code = u32(128) == DXGI_FORMAT_R16G16B16A16_FLOAT   ? std::uint64_t(D3DFMT_A16B16G16R16F)
                         : u32(128) == DXGI_FORMAT_R32G32B32A32_FLOAT ? std::uint64_t(D3DFMT_A32B32G32R32F)
                                                                      : 0;
            if (float_code == 0)
                fail("its texels have DXGI format " + std::to_string(u32(128)) +
                     "; 10 (half floats) and 2 (floats) can be read");
            if (u32(132) != D3D10_RESOURCE_DIMENSION_TEXTURE2D || (u32(136) & D3D10_RESOURCE_MISC_TEXTURECUBE) == 0)
                fail("it is not a cube map");
            if (u32(140) != 1)
                fail("it is an array of " + std::to_string(u32(140)) + " cube maps; give a single one");
        }
        if (float_code != D3DFMT_A16B16G16R16F && float_code != D3DFMT_A32B32G32R32F)
            fail("its texels are neither half floats nor floats; convert them first");
        format_ = float_code == D3DFMT_A16B16G16R16F ? TexelFormat::half_rgb : TexelFormat::float_rgb;
        if ((u32(112) & DDSCAPS2_CUBEMAP_ALLFACES) != DDSCAPS2_CUBEMAP_ALLFACES)
            fail("it is not a cube map with all six faces");
        size_ = u32(16);
        if (size_ < 1 || size_ > kLargestSize || u32(12) != size_)
            fail("its faces are " + std::to_string(size_) + " x " + std::to_string(u32(12)) +
                 " texels; a cube's are square and at most " + std::to_string(kLargestSize) + " wide");
        levels_ = (u32(8) & DDSD_MIPMAPCOUNT) != 0 ? std::max<std::uint64_t>(u32(28), 1) : 1;
        if (levels_ > 15 || size_ >> (levels_ - 1) == 0)
            fail("it has " + std::to_string(levels_) + " levels, more than faces of " + std::to_string(size_) +
                 " texels can");
        std::uint64_t wanted = texels_at_;
        for (std::uint64_t i = 0; i < levels_; ++i)
            wanted += 6 * (size_ >> i) * (size_ >> i) * file_texel_bytes(format_);
        if (bytes_.size() != wanted)
            fail("it has " + std::to_string(bytes_.size()) + " bytes; " + std::to_string(levels_) +
                 " levels of six faces from " + std::to_string(size_) + " x " + std::to_string(size_) +
                 " texels on take " + std::to_string(wanted) +
                 (bytes_.size() < wanted ? ": it is cut off" : ": it is damaged"));
    }

    void describe_lobes(CubeFile& file) const {
        if (u32(kNotes) != four_characters("KOKA"))
            return;
        const auto notes = bytes_.subspan(kNotes + 12, 4 * kMostLevels);
        if (u32(kNotes + 8) != notes_checksum(u32(kNotes + 4), notes, bytes_.subspan(texels_at_)))
            fail("its texels or notes are not those that were written (the checksum in dwReserved1 differs); it is "
                 "damaged, or another program changed it");
        if (levels_ > kMostLevels || u32(kNotes + 4) > 1)
            fail("its notes on the levels' lobes do not fit its levels; they are damaged");
        file.cube.kind = u32(kNotes + 4) == 0 ? LobeKind::phong : LobeKind::ggx;
        const bool ggx = file.cube.kind == LobeKind::ggx;
        for (std::size_t i = 0; i < file.cube.levels.size(); ++i) {
            PrefilteredCube::Level& level = file.cube.levels[i];
            const float p = std::bit_cast<float>(std::uint32_t(little_endian(notes, 4 * i, 4)));
            level.unfiltered = p == -1;
            level.parameter = !level.unfiltered ? double(p) : ggx ? 0 : std::numeric_limits<double>::infinity();
            if (!level.unfiltered && !(ggx ? p > 0 && p <= 1 : p >= 0 && p <= 1e9f))
                fail("its notes on the lobe of level " + std::to_string(i) + " are damaged");
        }
        file.lobes_known = true;
        file.writer = "kokage";
    }

    std::string name_;
    std::span<const unsigned char> bytes_;
    TexelFormat format_ = TexelFormat::half_rgb;
    std::uint64_t size_ = 0, levels_ = 0;
    std::size_t texels_at_ = 0;
};

} // namespace

CubeFileBytes dds_bytes(const PrefilteredCube& cube, TexelFormat format, const std::string& name) {
    check_levels(cube, name);
    check_finite(cube, name);
    if (format == TexelFormat::shared_exponent)
        throw InputError(name + ": DDS is written with half floats or floats; for shared exponents take .ktx2");
    if (cube.levels.size() > kMostLevels)
        throw InputError(name + ": a DDS file has room for the roughness of " + std::to_string(kMostLevels) +
                         " levels, not of " + std::to_string(cube.levels.size()) + "; take .ktx2, or fewer levels");
    const std::size_t size = std::size_t(cube.levels[0].size), each = file_texel_bytes(format);
    ByteWriter notes;
    for (const PrefilteredCube::Level& level : cube.levels)
        notes.u32(std::bit_cast<std::uint32_t>(level.unfiltered ? -1.f : float(level.parameter)));
    notes.bytes.resize(4 * kMostLevels);

    std::size_t end = kHeaderBytes + kDx10Bytes;
    for (const PrefilteredCube::Level& level : cube.levels)
        end += level.texels.size() * each;
    UninitializedVector<unsigned char> bytes(end);
    CubeFileSummary summary{end, 0};
    std::size_t at = kHeaderBytes + kDx10Bytes;
    for (std::size_t face = 0; face < 6; ++face)
        for (const PrefilteredCube::Level& level : cube.levels) {
            const std::size_t count = level.texels.size() / 6;
            summary.clamped_texels +=
                encode_texels(std::span(level.texels).subspan(face * count, count), format, bytes.data() + at);
            at += count * each;
        }

    ByteWriter head;
    head.text("DDS ");
    for (const std::size_t number :
         {std::size_t(124),
          std::size_t(DDSD_CAPS | DDSD_HEIGHT | DDSD_WIDTH | DDSD_PITCH | DDSD_PIXELFORMAT | DDSD_MIPMAPCOUNT), size,
          size, size * each, std::size_t(0), cube.levels.size()})
        head.u32(number);
    head.text("KOKA");
    const std::uint32_t lobe = cube.kind == LobeKind::ggx ? 1 : 0;
    head.u32(lobe);
    head.u32(notes_checksum(lobe, notes.bytes, std::span<const unsigned char>(bytes.data(), end).subspan(148)));
    head.bytes.insert(head.bytes.end(), notes.bytes.begin(), notes.bytes.end());
    for (const std::uint32_t number :
         {32u, std::uint32_t(DDPF_FOURCC), four_characters("DX10"), 0u, 0u, 0u, 0u, 0u, // pixel format
          std::uint32_t(DDSCAPS_COMPLEX | DDSCAPS_TEXTURE | DDSCAPS_MIPMAP), std::uint32_t(DDSCAPS2_CUBEMAP_ALLFACES),
          0u, 0u, 0u, // caps3, caps4, reserved
          std::uint32_t(format == TexelFormat::half_rgb ? DXGI_FORMAT_R16G16B16A16_FLOAT
                                                        : DXGI_FORMAT_R32G32B32A32_FLOAT),
          std::uint32_t(D3D10_RESOURCE_DIMENSION_TEXTURE2D), std::uint32_t(D3D10_RESOURCE_MISC_TEXTURECUBE), 1u, 0u})
        head.u32(number);
    std::copy(head.bytes.begin(), head.bytes.end(), bytes.begin());

    return {std::move(bytes), summary};
}

CubeFileSummary write_dds(const std::filesystem::path& path, const PrefilteredCube& cube, TexelFormat format) {
    const CubeFileBytes made = dds_bytes(cube, format, path.string());
    write_file(path, std::span(made.bytes));
    return made.summary;
}

CubeFile read_dds(const std::filesystem::path& path) {
    return read_dds(read_file_bytes(path, kMostBytes), path.string());
}

CubeFile read_dds(std::span<const unsigned char> bytes, const std::string& name) {
    return DdsReader(name, bytes).read();
}

} // namespace kokage

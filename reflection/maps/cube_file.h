#pragma once
// Prefiltered cube maps as files: Khronos' KTX 2.0 and Microsoft's DDS, written and read back.
//
// What lies in them, texel for texel, is PrefilteredCube as prefiltered_cube.h draws it; alpha, where the format has
// it, is 1. Each level's lobe is written down:
//
//   KTX 2  key/value data: kokage.lobe        "ggx" or "phong"
//                          kokage.parameters  one number a level, level 0 first, separated by spaces: glTF's roughness,
//                                             or Phong's exponent; "image" for a level that is the image itself
//                          kokage.checksum    of the levels' bytes, so that a file that was altered is told; a program
//                                             that changes texels has to drop it
//          With even_roughness() as parameters, levels are those of glTF's EXT_lights_image_based: of n levels, level i
//          has roughness i / (n-1). A host reads level = roughness (n-1), between levels linearly, and needs no key.
//   DDS    the header's dwReserved1: "KOKA", lobe (0 Phong, 1 GGX), the checksum, then up to 8 levels' numbers as
//          floats, so that they read back with a float's precision; the image itself is -1.
//
// A file of another program has no such notes: it is read as GGX with even roughness, and the result says so.
#include "common/services/uninitialized_vector.h"
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/texel_format.h"

#include <filesystem>
#include <string>

namespace kokage {

struct CubeFileSummary {
    std::size_t bytes = 0;
    /// Texels that the format can't hold: brighter than its largest value (65504 as half, 65408 with a shared exponent;
    /// they became that), or negative (with a shared exponent; they became 0).
    std::size_t clamped_texels = 0;
};

/// VK_FORMAT_R16G16B16A16_SFLOAT, R32G32B32A32_SFLOAT or E5B9G9R9_UFLOAT_PACK32 for half_rgb, float_rgb,
/// shared_exponent; not supercompressed. Whole or not at all (OutputFile). Throws InputError for values that are not
/// finite, with their place, and for files that can't be written.
CubeFileSummary write_ktx2(const std::filesystem::path& path, const PrefilteredCube& cube, TexelFormat format);

/// A DDS has room for no more levels' lobes.
inline constexpr int kMostDdsLevels = 8;
/// DDS with a DX10 header: DXGI_FORMAT_R16G16B16A16_FLOAT or R32G32B32A32_FLOAT, each face with all its levels.
/// Shared exponents are refused (few readers know them), and so are more than kMostDdsLevels.
CubeFileSummary write_dds(const std::filesystem::path& path, const PrefilteredCube& cube, TexelFormat format);

/// What the writers above write; `name` begins the messages.
struct CubeFileBytes {
    UninitializedVector<unsigned char> bytes;
    CubeFileSummary summary;
};
CubeFileBytes ktx2_bytes(const PrefilteredCube& cube, TexelFormat format, const std::string& name);
CubeFileBytes dds_bytes(const PrefilteredCube& cube, TexelFormat format, const std::string& name);

struct CubeFile {
    PrefilteredCube cube;
    TexelFormat format = TexelFormat::half_rgb;
    std::string writer;       ///< KTXwriter, as far as it is text; "" if there is none
    bool lobes_known = false; ///< false: another program's file, whose levels' roughness is assumed to be even
};

/// Reads what the writers above write, and other programs' cube maps in the same formats. Everything is checked before
/// it is used. Throws InputError, one line that begins with the path and says what is wrong: not a KTX 2 file, another
/// version, cut off, sizes that contradict each other, a format that is none of the above, values that are not finite.
CubeFile read_ktx2(const std::filesystem::path& path);
CubeFile read_dds(const std::filesystem::path& path);
/// The same from a file's bytes; `name` begins the messages.
CubeFile read_ktx2(std::span<const unsigned char> bytes, const std::string& name);
CubeFile read_dds(std::span<const unsigned char> bytes, const std::string& name);

} // namespace kokage

#pragma once
// RGB pictures with notes in their headers, as EXR files whose content is checked. For the maps' files alone, but for
// ExrCompression.
#include "common/scene/image.h"
#include "reflection/maps/texel_format.h"

#include <filesystem>
#include <map>
#include <string>

namespace kokage {

/// Attributes "kokage:KEY" of a file, by KEY.
using ExrNotes = std::map<std::string, std::string>;

struct ExrHeader {
    int width = 0, height = 0;
    ExrNotes notes;
};

/// How EXR files are compressed; all of them are lossless.
enum class ExrCompression {
    zip,  ///< smallest, slowest to write
    rle,  ///< pays where many pixels are alike
    none, ///< fastest to write and to read
};

/// Three channels as they lie in a file.
struct ExrPixels {
    int width = 0, height = 0;
    bool halves = true;           ///< else floats
    std::vector<std::byte> bytes; ///< row by row, as packed_texels gives them
    int tile = 0;                 ///< the file is cut into squares of this edge; 0: into rows
};
ExrPixels exr_pixels(const Image& image, bool halves);

/// Writes pixels with the notes and a checksum of all of it. Whole or not at all. Throws InputError.
void write_noted_exr(const std::filesystem::path& path, const ExrPixels& pixels, const ExrNotes& notes,
                     ExrCompression compression = ExrCompression::zip);

/// Throws InputError "cannot read map '...': ..." for what is no EXR file of three channels.
ExrHeader read_exr_header(const std::filesystem::path& path);
/// The pixels that belong to a header. Throws InputError where they can't be read whole, or differ from those that were
/// written.
Image read_noted_exr(const std::filesystem::path& path, const ExrHeader& header);

} // namespace kokage

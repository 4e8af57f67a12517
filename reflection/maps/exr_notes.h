#pragma once
// RGB pictures with notes in their headers, as EXR files whose content is checked. Inside of the maps' files alone.
#include "common/scene/image.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace kokage {

/// Attributes "kokage:KEY" of a file, by KEY.
using ExrNotes = std::map<std::string, std::string>;

struct ExrHeader {
    int width = 0, height = 0;
    ExrNotes notes;
};

/// Writes three channels as halves or floats, lossless, with the notes and a checksum of all of it. Whole or not at
/// all. Throws InputError.
void write_noted_exr(const std::filesystem::path& path, const Image& image, bool halves, const ExrNotes& notes);

/// Throws InputError "cannot read map '...': ..." for what is no EXR file of three channels.
ExrHeader read_exr_header(const std::filesystem::path& path);
/// The pixels that belong to a header. Throws InputError where they can't be read whole, or differ from those that were
/// written.
Image read_noted_exr(const std::filesystem::path& path, const ExrHeader& header);

/// The shortest text that reads back as the same number.
std::string number_text(double value);
/// Nothing for what is no finite number.
std::optional<double> number_from_text(const std::string& text);

} // namespace kokage

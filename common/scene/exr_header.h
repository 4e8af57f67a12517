#pragma once
// OpenEXR takes memory for whatever a header announces before it looks for it: gigabytes, where a header is damaged. So
// headers are looked at before. Private to readers of EXR files.
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace kokage {

/// What in the header of an EXR file can't be: attributes that reach beyond the file's end, more chunks of pixels
/// (lines or tiles) than their table has bytes for, a frame without pixels. Empty if all of it can, and where the file
/// is no EXR file at all. ("The OpenEXR file layout", openexr.com.)
std::string exr_header_problem(const std::filesystem::path& path);
std::string exr_header_problem(std::span<const std::byte> bytes);

} // namespace kokage

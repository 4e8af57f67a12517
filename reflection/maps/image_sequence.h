#pragma once
// Many images in order: the frames of a video.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

struct SequenceImage {
    std::uint64_t number = 0; ///< its own in a pattern, else its place from 1
    std::filesystem::path file;
};

/// A place for a number in a name, as printf has it: "frame_%04d.exr" (%d, or %0Nd with N up to 18). Exactly one.
bool has_number_place(const std::string& name);
/// The name with a number in that place.
std::string numbered_name(const std::string& pattern, std::uint64_t number);

/// True for what image_sequence() takes: a pattern, a folder, or a list (.txt).
bool names_a_sequence(const std::string& name);

/// Images in the order of their numbers (pattern: all files that fit, gaps are no frames), of their names (folder:
/// .exr, .hdr, .png, .jpg, .jpeg, .tif, .tiff, .webp) or as they are listed (a name a line, relative to the list's
/// folder; empty lines and those that begin with # are skipped; what is listed need not be there). Throws InputError
/// where there are none.
std::vector<SequenceImage> image_sequence(const std::string& name);

} // namespace kokage

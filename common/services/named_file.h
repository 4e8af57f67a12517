#pragma once
// Files that are named by other files: a glTF's buffers and images, an OBJ's materials and textures.
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// A whole file's bytes. Throws InputError, one line that begins with the path: no such file, not a regular file,
/// larger than `most`.
std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path, std::uint64_t most);

/// How far a name may lead. Bytes that are taken as they are (buffers, materials' text) must lie in the naming file's
/// own folder or below it: a file of a stranger can't carry away what else is on the disk. Images may also lie in a
/// neighbouring folder ("../textures/leaf.png" is common), as nothing but a valid image is ever read from there.
enum class NameReach { own_folder, relative };

/// The file that `name` stands for in a file of `folder`: percent escapes decoded (RFC 3986), else the name as it is
/// written, else with '\' read as '/'; the first that exists. Throws InputError "<owner>: ..." for a name that is
/// absolute, leads farther than `reach`, is an address on the net, or names no file: each says how to mend it.
std::filesystem::path find_named_file(const std::filesystem::path& folder, const std::string& name, NameReach reach,
                                      const std::string& owner);
/// The same; an empty path where that throws.
std::filesystem::path look_for_named_file(const std::filesystem::path& folder, const std::string& name,
                                          NameReach reach);

/// A name's ending in lower case (".glb"); empty if there is none.
std::string lower_ending(const std::filesystem::path& path);

/// Percent escapes decoded; what is no valid escape stays as it is.
std::string percent_decoded(const std::string& text);

/// Text for a terminal: control characters (line breaks, escapes, U+0080 to U+009F) become '?'.
std::string without_controls(std::string text);
/// A name for messages: control characters replaced, long ones shortened.
std::string shown_name(const std::string& name);

} // namespace kokage

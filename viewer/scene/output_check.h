#pragma once
// Finds before the work begins what would make it useless after: a file that can't be written.
#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace kokage {

/// Throws InputError if `path` has none of the endings, is a folder, or can't be written where it is. `what` names the
/// file in messages ("the picture").
void check_output(const std::filesystem::path& path, std::string_view what,
                  std::initializer_list<std::string_view> endings);

/// Throws InputError if two of the program's inputs and outputs are one file, which would be overwritten.
void check_distinct(std::initializer_list<std::filesystem::path> files);

} // namespace kokage

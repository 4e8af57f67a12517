#pragma once
// What a command says of a file that it wrote.
#include <filesystem>

namespace kokage {

/// Prints where the file is and its size; nothing for an empty path.
void print_file(const std::filesystem::path& file);

} // namespace kokage

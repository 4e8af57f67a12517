#pragma once
// The folder that trees and environments are also looked for in: --data, or the environment variable KOKAGE_DATA.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// Adds --data; `what`: what is looked for there ("TREE is").
void add_data_option(CLI::App& app, std::filesystem::path& data, const std::string& what);

/// Names that are no file here become files of the data folder, of its env or of its trees, where they are there.
/// Throws InputError if `data` is given and no folder.
void find_in_data(const std::filesystem::path& data, const std::vector<std::string*>& names);

} // namespace kokage

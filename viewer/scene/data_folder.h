#pragma once
// The folder that trees and environments are also looked for in: --data, or the environment variable KOKAGE_DATA.
#include "viewer/scene/cli_forward.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// Adds --data; `what`: what is looked for there ("TREE is").
void add_data_option(CLI::App& app, std::filesystem::path& data, const std::string& what);

/// A folder `data` and those in it that are looked into; none if it is empty. Throws InputError if it is no folder.
std::vector<std::filesystem::path> folders_of_data(const std::filesystem::path& data);

/// For the end of a complaint that `name` is no file: "; it was looked for here, in ..."; empty for a whole path.
std::string looked_for_in(const std::string& name, const std::filesystem::path& data);

/// Names that are no file here become files of the data folder, or of the folders in it, where they are there.
/// Throws InputError if `data` is given and no folder.
void find_in_data(const std::filesystem::path& data, const std::vector<std::string*>& names);

} // namespace kokage

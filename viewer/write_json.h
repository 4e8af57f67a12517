#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace kokage {

/// Writes JSON, indented, whole or not at all. Bytes that are no UTF-8 (in names of files and materials) become U+FFFD.
void write_json(const std::filesystem::path& path, const nlohmann::ordered_json& json);

} // namespace kokage

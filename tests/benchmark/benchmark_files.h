#pragma once
// What every benchmark leaves behind: records for programs, and a page for people.
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace kokage {

struct BenchmarkPage {
    std::string title;
    double calibration_cpu_seconds = 0; ///< of calibration_seconds(), so that two machines can be compared
    std::string figures, table;         ///< Markdown
    std::vector<std::string> notes;     ///< what was skipped, failed, drawn
};

/// Writes NAME.json (the records) and NAME.md (the page) into the folder, each whole or not at all.
void write_benchmark(const std::filesystem::path& folder, const std::string& name, const nlohmann::json& records,
                     const BenchmarkPage& page);

} // namespace kokage

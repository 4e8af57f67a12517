#pragma once
// What the records of `kokage bench reflection` come to: figures beside their targets, tables, plots.
#include "tests/benchmark/reflection_record.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// A Markdown table: figure, measured, target, met or short; "not measured" where a record is missing.
std::string reflection_figures(const std::vector<ReflectionRecord>& records);

/// The paper's tables 2 and 3 beside ours, and what makes them differ; then all records, an experiment a table.
std::string reflection_tables(const std::vector<ReflectionRecord>& records);

/// reflection-error.svg: CPU time against mean error of a cube of 128, all methods. Returns what was drawn, or why not.
std::string plot_reflection(const std::vector<ReflectionRecord>& records, const std::filesystem::path& folder);

} // namespace kokage

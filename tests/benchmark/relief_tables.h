#pragma once
// What the records of `kokage bench relief` come to: figures beside their targets, tables, plots.
#include "tests/benchmark/relief_record.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// A Markdown table: figure, measured, target, met or short; "not measured" where a record is missing.
std::string relief_figures(const std::vector<ReliefRecord>& records);

/// The paper's figures beside ours; a line for every map and method; then all records, an experiment a table.
std::string relief_tables(const std::vector<ReliefRecord>& records);

/// relief-error.svg: time a ray against wrong hits, all methods and maps; relief-reads.svg: reads against the view's
/// angle. Returns what was drawn, or why not.
std::string plot_relief(const std::vector<ReliefRecord>& records, const std::filesystem::path& folder);

} // namespace kokage

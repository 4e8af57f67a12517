#pragma once
// What `kokage bench trees` tells people: tables and plots.
#include "tests/benchmark/tree_record.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// Markdown: the slowest species at 100,000 leaves beside the targets, and how much faster than others we are at like
/// numbers of leaves.
std::string growth_figures(const std::vector<TreeRecord>& records);
/// Markdown: one row a record.
std::string growth_table(const std::vector<TreeRecord>& records);

/// CPU seconds of `record`'s generator and species at so many leaves, between measured numbers of leaves (log-log);
/// empty outside of what was measured.
std::optional<double> cpu_seconds_at(const std::vector<TreeRecord>& records, const std::string& generator,
                                     const std::string& species, double leaves);

/// trees-time.svg and trees-memory.svg, by the program gnuplot. Returns a line that says what was drawn, or
/// "plots skipped: ..." and why.
std::string plot_trees(const std::vector<TreeRecord>& records, const std::filesystem::path& folder);

} // namespace kokage

#pragma once
#include "tests/benchmark/foliage_summary.h"

#include <string>
#include <vector>

namespace kokage {

/// Markdown: a figure, its target, and whether it was met.
std::string summary_table(const std::vector<SummaryFigure>& figures);
/// Markdown: one row a record.
std::string record_table(const std::vector<FoliageRecord>& records);

} // namespace kokage

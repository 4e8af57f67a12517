#pragma once
#include "tests/benchmark/foliage_record.h"

#include <filesystem>
#include <string>
#include <vector>

namespace kokage {

/// Draws error against CPU time, one SVG a scene (foliage-30000-realistic-sky-sun.svg), by the program gnuplot.
/// Returns a line that says what was drawn, or "plots skipped: ..." and why.
std::string plot_efforts(const std::vector<FoliageRecord>& records, const std::filesystem::path& folder);

/// The gnuplot script of one scene's plot: the records are all of that scene.
std::string plot_script(const std::vector<FoliageRecord>& records, const std::string& output_file);

} // namespace kokage

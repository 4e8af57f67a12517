#pragma once
// What render.json says, for people.
#include "tests/benchmark/render_record.h"

#include <filesystem>
#include <vector>

namespace kokage {

/// CPU of path tracing over that of the fast way at the fast picture's error, interpolated in log-log between the
/// sample counts that were traced and judged; beyond them path tracing's error is taken to fall with the root of its
/// time. Empty where the truth is too noisy to judge the fast picture, or nothing was traced.
std::optional<double> times_less_cpu(const std::vector<PictureRecord>& records, const PictureRecord& fast);
/// Sets it in all fast records.
void compare_times(std::vector<PictureRecord>& records);

std::string render_figures(const std::vector<PictureRecord>& records); ///< beside the promises
std::string render_tables(const std::vector<PictureRecord>& records);  ///< all of them
/// Error against time, an SVG a scene. Says what was drawn or why not.
std::string plot_render(const std::vector<PictureRecord>& records, const std::filesystem::path& folder);

} // namespace kokage

#pragma once
// What render.json says, for people.
#include "tests/benchmark/render_record.h"

#include <filesystem>
#include <vector>

namespace kokage {

/// CPU of path tracing over that of the fast way at the fast picture's error, interpolated in log-log; empty where that
/// error lies outside of what was traced, or the truth is too noisy to judge it.
std::optional<double> times_less_cpu(const std::vector<PictureRecord>& records, const PictureRecord& fast);

/// Error judged by a truth whose noise is at most a fifth of it.
bool is_judged(const PictureRecord& record);

std::string render_figures(const std::vector<PictureRecord>& records); ///< beside the promises
std::string render_tables(const std::vector<PictureRecord>& records);  ///< all of them
/// Error against time, an SVG a scene. Says what was drawn or why not.
std::string plot_render(const std::vector<PictureRecord>& records, const std::filesystem::path& folder);

} // namespace kokage

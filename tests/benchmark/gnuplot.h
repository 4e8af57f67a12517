#pragma once
// Plots by the program gnuplot.
#include <filesystem>
#include <functional>
#include <string>

namespace kokage {

/// What notes say where has_gnuplot() is false.
inline constexpr const char* kNoGnuplot = "plots skipped: the program gnuplot is not installed";
bool has_gnuplot();

/// Draws an SVG by the script that `script_for` gives for a file's name. The plot appears whole or not at all; returns
/// false if gnuplot failed.
bool draw_plot(const std::filesystem::path& path,
               const std::function<std::string(const std::string& file)>& script_for);

} // namespace kokage

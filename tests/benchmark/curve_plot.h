#pragma once
// Plots of curves, one a method.
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace kokage {

/// Points of each curve in the order in which they are joined, by the curve's name.
using Curves = std::map<std::string, std::vector<std::pair<double, double>>>;

enum class CurveStyle { lines, points };

/// A script for draw_plot: `settings` are gnuplot's own ("set xlabel 'reads'\n").
std::string curves_script(const Curves& curves, const std::string& settings, const std::string& file,
                          CurveStyle style = CurveStyle::lines);

} // namespace kokage

#pragma once
// Tables for people, as Markdown.
#include <optional>
#include <string>
#include <vector>

namespace kokage {

/// "| a | b |" and a line break.
std::string markdown_row(const std::vector<std::string>& cells);
/// Three digits that count, or a dash if there is no value or it is not finite.
std::string three_digits(std::optional<double> value, double scale = 1);

} // namespace kokage

#include "tests/benchmark/markdown.h"

#include <cmath>
#include <cstdio>

namespace kokage {

std::string markdown_row(const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells)
        text += " " + cell + " |";
    return text + "\n";
}

std::string three_digits(std::optional<double> value, double scale) {
    if (!value || !std::isfinite(*value))
        return "–";
    const double scaled = *value * scale, size = std::abs(scaled);
    char text[32];
    std::snprintf(text, sizeof text, size >= 100 ? "%.0f" : size >= 10 ? "%.1f" : size >= 1 ? "%.2f" : "%.3f", scaled);
    return text;
}

} // namespace kokage

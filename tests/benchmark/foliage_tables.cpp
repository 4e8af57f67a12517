#include "tests/benchmark/foliage_tables.h"

#include <cmath>
#include <cstdio>

namespace kokage {

namespace {

/// Three digits that count, or a dash.
std::string digits(std::optional<double> value, double scale = 1) {
    if (!value || !std::isfinite(*value))
        return "–";
    const double scaled = *value * scale, size = std::abs(scaled);
    char text[32];
    std::snprintf(text, sizeof text, size >= 100 ? "%.0f" : size >= 10 ? "%.1f" : size >= 1 ? "%.2f" : "%.3f", scaled);
    return text;
}

std::string plain(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

std::string row(const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells)
        text += " " + cell + " |";
    return text + "\n";
}

} // namespace

std::string summary_table(const std::vector<SummaryFigure>& figures) {
    std::string text = row({"figure", "measured", "target", ""}) + row({"---", "---:", "---:", "---"});
    for (const SummaryFigure& figure : figures) {
        const std::string target = figure.target ? (figure.at_least ? "≥ " : "≤ ") + digits(figure.target) : "";
        const char* verdict = !figure.target ? "" : !figure.value ? "not measured" : figure.met() ? "met" : "**short**";
        text += row({figure.what, digits(figure.value) + (figure.value ? " " + figure.unit : ""), target, verdict});
    }
    return text;
}

std::string record_table(const std::vector<FoliageRecord>& records) {
    std::string text =
        row({"scene", "leaves", "material", "method", "effort", "CPU s", "relight CPU s", "bytes/leaf", "MRE %",
             "p95 %", "RMSE/mean %", "bias %", "estimated %", "noise of reference %", "judged"}) +
        row(std::vector<std::string>(15, "---"));
    for (const FoliageRecord& r : records)
        text += row({r.scene, std::to_string(r.leaves), r.material, std::string(method_name(r.method)),
                     plain(r.effort) + " " + r.effort_kind, digits(r.cpu_seconds), digits(r.relight_cpu_seconds),
                     digits(r.bytes_per_leaf), digits(r.accuracy.mre, 100), digits(r.accuracy.p95, 100),
                     digits(r.accuracy.rmse_over_mean, 100), digits(r.accuracy.bias, 100),
                     digits(r.estimated_error, 100), digits(r.reference_noise, 100), r.judged() ? "yes" : "no"});
    return text;
}

} // namespace kokage

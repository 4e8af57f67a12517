#include "tests/benchmark/foliage_tables.h"
#include "tests/benchmark/markdown.h"

#include <cstdio>

namespace kokage {

namespace {

std::string plain(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

} // namespace

std::string summary_table(const std::vector<SummaryFigure>& figures) {
    std::string text =
        markdown_row({"figure", "measured", "target", ""}) + markdown_row({"---", "---:", "---:", "---"});
    for (const SummaryFigure& figure : figures) {
        const std::string target = figure.target ? (figure.at_least ? "≥ " : "≤ ") + three_digits(figure.target) : "";
        const char* verdict = !figure.target ? "" : !figure.value ? "not measured" : figure.met() ? "met" : "**short**";
        text += markdown_row(
            {figure.what, three_digits(figure.value) + (figure.value ? " " + figure.unit : ""), target, verdict});
    }
    return text;
}

std::string record_table(const std::vector<FoliageRecord>& records) {
    std::string text =
        markdown_row({"scene", "leaves", "material", "method", "effort", "CPU s", "relight CPU s", "bytes/leaf",
                      "MRE %", "p95 %", "RMSE/mean %", "bias %", "estimated %", "noise of reference %", "judged"}) +
        markdown_row(std::vector<std::string>(15, "---"));
    for (const FoliageRecord& r : records)
        text += markdown_row(
            {r.scene, std::to_string(r.leaves), r.material, std::string(method_name(r.method)),
             plain(r.effort) + " " + r.effort_kind, three_digits(r.cpu_seconds), three_digits(r.relight_cpu_seconds),
             three_digits(r.bytes_per_leaf), three_digits(r.accuracy.mre, 100), three_digits(r.accuracy.p95, 100),
             three_digits(r.accuracy.rmse_over_mean, 100), three_digits(r.accuracy.bias, 100),
             three_digits(r.estimated_error, 100), three_digits(r.reference_noise, 100), r.judged() ? "yes" : "no"});
    return text;
}

} // namespace kokage

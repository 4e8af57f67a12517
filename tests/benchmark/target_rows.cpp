#include "tests/benchmark/target_rows.h"
#include "tests/benchmark/markdown.h"

namespace kokage {
namespace {

std::string row(const std::string& what, std::optional<double> measured, const std::string& target,
                const std::string& unit, bool met) {
    return markdown_row({what, measured ? three_digits(measured) + unit : "–", target + unit,
                         !measured ? "not measured"
                         : met     ? "met"
                                   : "**short**"});
}

} // namespace

std::string at_most(const std::string& what, std::optional<double> measured, double target, const std::string& unit) {
    return row(what, measured, "≤ " + three_digits(target), unit, measured && *measured <= target);
}

std::string at_least(const std::string& what, std::optional<double> measured, double target, const std::string& unit) {
    return row(what, measured, "≥ " + three_digits(target), unit, measured && *measured >= target);
}

std::string target_head() {
    return markdown_row({"figure (the worst of all that were measured)", "measured", "target", ""}) +
           markdown_row({"---", "---:", "---:", "---"});
}

std::optional<double> times(std::optional<double> value, double factor) {
    return value ? std::optional(*value * factor) : std::nullopt;
}

} // namespace kokage

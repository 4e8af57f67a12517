#include "reflection/relief/relief_tracer.h"
#include "common/services/error.h"

#include <array>
#include <string>
#include <utility>

namespace kokage {
namespace {

constexpr std::array<std::pair<ReliefMethod, std::string_view>, 6> kNames{{
    {ReliefMethod::exact, "exact"},
    {ReliefMethod::linear, "linear"},
    {ReliefMethod::depth_maps, "depth-maps"},
    {ReliefMethod::conservative, "conservative"},
    {ReliefMethod::cone, "cone"},
    {ReliefMethod::cell_by_cell, "cell-by-cell"},
}};

} // namespace

std::string_view relief_method_name(ReliefMethod method) {
    for (const auto& [value, name] : kNames)
        if (value == method)
            return name;
    return "?";
}

ReliefMethod relief_method_from_name(std::string_view name) {
    std::string known;
    for (const auto& [value, known_name] : kNames) {
        if (known_name == name)
            return value;
        known += (known.empty() ? "" : ", ") + std::string(known_name);
    }
    throw InputError("relief method \"" + std::string(name) + "\" is not known; known are: " + known);
}

} // namespace kokage

#include "trees/growth/parameters.h"

#include "common/services/error.h"
#include "common/services/nearest_word.h"
#include "trees/growth/parameter_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace kokage {
namespace {

std::string shown_number(double value) {
    // The shortest that reads back as the same; without an exponent where that is readable.
    char text[64];
    const bool plain = value == 0 || (std::abs(value) >= 1e-4 && std::abs(value) < 1e17);
    return {text, (plain ? std::to_chars(text, text + sizeof text, value, std::chars_format::fixed)
                         : std::to_chars(text, text + sizeof text, value))
                      .ptr};
}

/// What sets things that artists ask for by other names than ours; empty for other words.
std::string hint_for(std::string_view name) {
    const auto is_one_of = [&](std::initializer_list<std::string_view> words) {
        return std::find(words.begin(), words.end(), name) != words.end();
    };
    if (is_one_of({"height", "width", "size", "scale", "radius", "diameter", "spread", "age", "length"}))
        return "a tree's size follows from its leaves: 'leaves' is their number, 'leaf_length' their size, "
               "'leaf_area_index' how densely they stand, and 'height_to_width' the tree's shape";
    if (is_one_of({"trunk", "trunk_radius", "trunk_height", "trunk_length", "trunk_width", "girth", "thickness"}))
        return "the trunk follows from the tree's size; 'trunk_reach', 'crown_base', 'pipe_exponent' and 'root_flare' "
               "change it";
    if (is_one_of({"branches", "levels", "gravity", "angle"}))
        return "'limbs', 'branch_angle', 'branch_up' and 'light_need' shape the branches";
    if (is_one_of({"color", "colour", "leaf_colour"}))
        return "'season', 'leaf_color' and 'bark' set colours";
    if (is_one_of({"density", "foliage"}))
        return "'leaf_area_index' and 'leaves_per_shoot' set how densely leaves stand";
    return "";
}

const ParameterRow& find_row(std::string_view name) {
    std::vector<std::string> names;
    for (const ParameterRow& row : parameter_table()) {
        if (row.description.name == name)
            return row;
        names.push_back(row.description.name);
    }
    if (const std::string hint = hint_for(name); !hint.empty())
        throw InputError("no growth parameter is called '" + std::string(name) + "': " + hint +
                         ". 'kokage grow --describe oak' lists all");
    const std::optional<std::string> nearest = nearest_word(name, names);
    throw InputError("no growth parameter is called '" + std::string(name) + "'; " +
                     (nearest ? "did you mean '" + *nearest + "'? " : "") + "'kokage grow --describe oak' lists all");
}

void check(const ParameterDescription& description, double value) {
    const bool ok = std::isfinite(value) && value >= description.low && value <= description.high &&
                    (!description.whole || value == std::floor(value));
    if (!ok)
        throw InputError(description.name + " = " + shown_number(value) + " is out of range; it takes " +
                         range_text(description));
}

ParameterRow number_row(const char* name, const char* unit, double low, double high, bool is_whole, const char* meaning,
                        const char* source) {
    return {
        {.name = name, .unit = unit, .low = low, .high = high, .whole = is_whole, .meaning = meaning, .source = source},
        {},
        {}};
}

} // namespace

ParameterRow real(const char* name, double GrowthParameters::*member, const char* unit, double low, double high,
                  const char* meaning, const char* source) {
    ParameterRow row = number_row(name, unit, low, high, false, meaning, source);
    row.get = [member](const GrowthParameters& p) { return p.*member; };
    row.set = [member](GrowthParameters& p, double v) { p.*member = v; };
    return row;
}

ParameterRow whole(const char* name, int GrowthParameters::*member, const char* unit, double low, double high,
                   const char* meaning, const char* source) {
    ParameterRow row = number_row(name, unit, low, high, true, meaning, source);
    row.get = [member](const GrowthParameters& p) { return double(p.*member); };
    row.set = [member](GrowthParameters& p, double v) { p.*member = int(v); };
    return row;
}

const std::vector<ParameterRow>& parameter_table() {
    static const std::vector<ParameterRow> table = [] {
        std::vector<ParameterRow> rows = wood_rows();
        for (const std::vector<ParameterRow>& more : {leaf_rows(), look_rows()})
            rows.insert(rows.end(), more.begin(), more.end());
        return rows;
    }();
    return table;
}

std::string value_text(const ParameterDescription& d) {
    return d.choices.empty() ? shown_number(d.value) : d.choices.at(std::size_t(d.value - d.low));
}

std::string range_text(const ParameterDescription& d) {
    if (d.choices.empty())
        return (d.whole ? "a whole number, " : "") + shown_number(d.low) + " to " + shown_number(d.high) +
               (d.unit.empty() ? "" : " " + d.unit);
    std::string text;
    for (std::size_t i = 0; i < d.choices.size(); ++i)
        text += (i == 0 ? "" : i + 1 == d.choices.size() ? " or " : ", ") + d.choices[i];
    return text;
}

std::vector<ParameterDescription> parameter_descriptions(const GrowthParameters& parameters) {
    std::vector<ParameterDescription> result;
    for (const ParameterRow& row : parameter_table()) {
        result.push_back(row.description);
        result.back().value = row.get(parameters);
    }
    return result;
}

void set_parameter(GrowthParameters& parameters, std::string_view name, std::string_view value) {
    const ParameterRow& row = find_row(name);
    const std::vector<std::string>& choices = row.description.choices;
    const auto choice = std::find(choices.begin(), choices.end(), value);
    double number = double(choice - choices.begin());
    if (choice == choices.end()) {
        const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
        if (!choices.empty() || error != std::errc() || end != value.data() + value.size())
            throw InputError(row.description.name + " = '" + std::string(value) + "' can't be read; it takes " +
                             range_text(row.description));
    }
    check(row.description, number);
    row.set(parameters, number);
}

void set_parameter(GrowthParameters& parameters, std::string_view name, double value) {
    const ParameterRow& row = find_row(name);
    if (!row.description.choices.empty())
        throw InputError(row.description.name + " = " + shown_number(value) + " is a number; it takes " +
                         range_text(row.description));
    check(row.description, value);
    row.set(parameters, value);
}

void check_parameters(const GrowthParameters& parameters) {
    for (const ParameterRow& row : parameter_table())
        check(row.description, row.get(parameters));
}

} // namespace kokage

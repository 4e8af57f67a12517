#pragma once
// One row for each growth parameter: how it is called, what it takes, what it means and where its values come from.
#include "trees/growth/parameters.h"

#include <functional>
#include <string>
#include <vector>

namespace kokage {

struct ParameterRow {
    ParameterDescription description; ///< value is not set
    std::function<double(const GrowthParameters&)> get;
    std::function<void(GrowthParameters&, double)> set;
};

/// A row of a real number.
ParameterRow real(const char* name, double GrowthParameters::*member, const char* unit, double low, double high,
                  const char* meaning, const char* source = "");
/// A row of a whole number.
ParameterRow whole(const char* name, int GrowthParameters::*member, const char* unit, double low, double high,
                   const char* meaning, const char* source = "");
/// A row of a choice: the value is the number of the name.
template <class Choice>
ParameterRow choice(const char* name, Choice GrowthParameters::*member, std::vector<std::string> names,
                    const char* meaning, const char* source = "") {
    return {{.name = name,
             .low = 0,
             .high = double(names.size() - 1),
             .whole = true,
             .meaning = meaning,
             .source = source,
             .choices = std::move(names)},
            [member](const GrowthParameters& p) { return double(int(p.*member)); },
            [member](GrowthParameters& p, double v) { p.*member = Choice(int(v)); }};
}

/// The tree as a whole, its crown, trunk, limbs, branches and bark (parameters_of_wood.cpp).
std::vector<ParameterRow> wood_rows();
/// Shoots, leaves and what they look like (parameters_of_leaves.cpp).
std::vector<ParameterRow> leaf_rows();
/// Whose leaves and bark they are, and the season (parameters_of_looks.cpp).
std::vector<ParameterRow> look_rows();

/// All of them, in reading order.
const std::vector<ParameterRow>& parameter_table();

} // namespace kokage

#include "common/services/error.h"
#include "trees/growth.h"

#include <algorithm>
#include <cctype>

namespace kokage {

GrowthParameters oak_parameters() {
    return find_species("oak").parameters;
}

const std::vector<Species>& all_species() {
    // The defaults of GrowthParameters are the oak's.
    static const std::vector<Species> species = {
        {"oak",
         "Quercus robur",
         "pedunculate oak grown in the open: stout trunk, wide zigzag limbs, broad domed crown",
         {}},
    };
    return species;
}

const Species& find_species(std::string_view name) {
    std::string lower(name), known;
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return char(std::tolower(c)); });
    for (const Species& species : all_species()) {
        if (species.name == lower)
            return species;
        known += (known.empty() ? "" : ", ") + species.name;
    }
    throw InputError("no species is called '" + std::string(name) + "'; known species: " + known);
}

} // namespace kokage

#include "trees/species.h"

#include "common/services/error.h"
#include "trees/species_texts.h"

#include <algorithm>
#include <cctype>

namespace kokage {

GrowthParameters oak_parameters() {
    return find_species("oak").parameters;
}

const std::vector<Species>& all_species() {
    static const std::vector<Species> species = [] {
        std::vector<Species> all;
        for (const SpeciesText& file : species_texts())
            all.push_back(parse_species(file.text, std::string(file.name)));
        std::sort(all.begin(), all.end(), [](const Species& a, const Species& b) { return a.name < b.name; });
        return all;
    }();
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
    throw InputError("no species is called '" + std::string(name) + "'; known species: " + known +
                     "; a file of your own ends in .json");
}

} // namespace kokage

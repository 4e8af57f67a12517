#pragma once
#include <string_view>
#include <vector>

namespace kokage {

/// A file of trees/species as it was when the program was built.
struct SpeciesText {
    std::string_view name, text; ///< "oak.json" and all that it holds
};

/// All of them, by name. CMake writes the definition (species_texts.cpp.in).
std::vector<SpeciesText> species_texts();

} // namespace kokage

#pragma once
// Species: named sets of growth parameters, in short files that users copy and change.
#include "trees/growth/parameters.h"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace kokage {

/// What a species file holds (trees/species/oak.json; comments are allowed):
///
///     {
///       "name": "oak",
///       "latin_name": "Quercus robur",
///       "summary": "one line for lists",
///       "sources": ["where the figures come from"],
///       "parameters": {"height_to_width": 0.88}      <- those that differ from the defaults
///     }
struct Species {
    std::string name, latin_name, summary;
    std::vector<std::string> sources;
    GrowthParameters parameters;
};

/// Every species that comes with the program, by name.
const std::vector<Species>& all_species();
/// By name ("oak"), whatever the case. Throws InputError that lists the names.
const Species& find_species(std::string_view name);
/// A pedunculate oak (Quercus robur) that grew in the open.
GrowthParameters oak_parameters();

/// Reads a species from the text of a file; `file` names it in messages. Throws InputError with one line that says
/// file, key and how to mend it: not JSON (with line and column), unknown or doubled key (with the nearest known one),
/// wrong type, out of range.
Species parse_species(std::string_view text, const std::string& file);
/// The same from a file. Throws InputError also if it can't be read or has more than a megabyte.
Species read_species(const std::filesystem::path& file);

/// A species as a file with every parameter, each with its unit, range and meaning as a comment: one to start from.
/// parse_species reads the same species from it.
std::string species_file_text(const Species& species);

} // namespace kokage

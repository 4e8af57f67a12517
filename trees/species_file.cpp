// Reading and writing species files.
#include "common/services/error.h"
#include "common/services/json_reader.h"
#include "common/services/named_file.h"
#include "common/services/nearest_word.h"
#include "trees/species.h"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

namespace kokage {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t largest_file = 1 << 20, longest_line = 2000, longest_name = 80;
constexpr const char* how_to_start = "; 'kokage grow --describe oak -o new.json' writes a file that reads";

class SpeciesReader {
  public:
    SpeciesReader(std::string_view text, const std::string& file)
        : file_(file), json_(parse_json(text, file, how_to_start)) {
        const std::vector<std::string> known = {"name", "latin_name", "summary", "sources", "parameters"};
        if (!json_.is_object())
            fail("it holds no { } with a species", how_to_start);
        for (const auto& [key, value] : json_.items())
            if (std::find(known.begin(), known.end(), key) == known.end())
                fail("nothing is called '" + shown_name(key) + "' here; did you mean '" +
                     nearest_word(key, known).value_or("parameters") + "'?");
        species_.name = name();
        species_.latin_name = line("latin_name");
        species_.summary = line("summary");
        read_sources();
        species_.parameters.species = species_.name;
        read_parameters();
    }

    Species take() { return std::move(species_); }

  private:
    [[noreturn]] void fail(const std::string& what, const std::string& mend = "") const {
        std::string message = file_ + ": " + what + mend;
        for (char& c : message) // keys may hold line ends
            c = static_cast<unsigned char>(c) < 32 ? ' ' : c;
        throw InputError(message);
    }

    /// A line of text; empty if it is not given.
    std::string line(const char* key) const {
        if (!json_.contains(key))
            return "";
        if (!json_[key].is_string())
            fail("'" + std::string(key) + "' must be text in quotes");
        return checked(json_[key].get<std::string>(), key);
    }

    std::string checked(std::string text, const std::string& key) const {
        if (text.size() > longest_line)
            fail("'" + key + "' is longer than " + std::to_string(longest_line) + " letters");
        if (std::any_of(text.begin(), text.end(), [](unsigned char c) { return c < 32 || c == 127; }))
            fail("'" + key + "' must be one line of text");
        return text;
    }

    std::string name() const {
        const std::string text = line("name");
        if (text.empty() || text.size() > longest_name)
            fail("'name' must be given, of 1 to " + std::to_string(longest_name) +
                 " letters, for example \"name\": \"my oak\"");
        return text;
    }

    void read_sources() {
        if (!json_.contains("sources"))
            return;
        if (!json_["sources"].is_array())
            fail("'sources' must be a list of texts, [\"...\"]");
        for (const Json& source : json_["sources"]) {
            if (!source.is_string())
                fail("'sources' must be a list of texts, [\"...\"]");
            species_.sources.push_back(checked(source.get<std::string>(), "sources"));
        }
    }

    void read_parameters() {
        if (!json_.contains("parameters"))
            return;
        if (!json_["parameters"].is_object())
            fail("'parameters' must be { \"name\": value, ... }");
        for (const auto& [key, value] : json_["parameters"].items()) {
            if (!value.is_string() && !value.is_number())
                fail("parameters: '" + key + "' must be a number, or a name in quotes");
            try {
                if (value.is_string())
                    set_parameter(species_.parameters, key, std::string_view(value.get_ref<const std::string&>()));
                else
                    set_parameter(species_.parameters, key, value.get<double>());
            } catch (const InputError& error) {
                fail("parameters: " + std::string(error.what()));
            }
        }
    }

    std::string file_;
    Json json_;
    Species species_;
};

std::string quoted(const std::string& text) {
    return Json(text).dump();
}

} // namespace

Species parse_species(std::string_view text, const std::string& file) {
    return SpeciesReader(text, file).take();
}

Species read_species(const fs::path& file) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored))
        throw InputError("'" + file.string() + "' is a folder; give a species file (.json)");
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw InputError("there is no species file '" + file.string() + "' that can be read" + how_to_start);
    std::string text(largest_file + 1, '\0');
    stream.read(text.data(), std::streamsize(text.size()));
    if (stream.bad())
        throw InputError("'" + file.string() + "' can't be read; check the disk");
    text.resize(std::size_t(stream.gcount()));
    if (text.size() > largest_file)
        throw InputError("'" + file.string() + "' has more than a megabyte; a species file is a few kilobytes" +
                         how_to_start);
    return parse_species(text, file.string());
}

std::string species_file_text(const Species& species) {
    std::string text = "// A species file of kokage: change what you like, leave out what is as the default.\n"
                       "// Grow it with: kokage grow THIS_FILE.json\n{\n";
    text += "  \"name\": " + quoted(species.name) + ",\n  \"latin_name\": " + quoted(species.latin_name) +
            ",\n  \"summary\": " + quoted(species.summary) + ",\n  \"sources\": [";
    for (std::size_t i = 0; i < species.sources.size(); ++i)
        text += (i ? ",\n    " : "\n    ") + quoted(species.sources[i]);
    text += species.sources.empty() ? "],\n  \"parameters\": {" : "\n  ],\n  \"parameters\": {";
    std::string group;
    const std::vector<ParameterDescription> all = parameter_descriptions(species.parameters);
    for (std::size_t i = 0; i < all.size(); ++i) {
        const ParameterDescription& p = all[i];
        if (p.group != group)
            text += "\n\n    // " + (group = p.group) + "\n";
        text += "\n    // " + p.meaning + " (" + range_text(p) + ")" + (p.source.empty() ? "" : " [" + p.source + "]");
        text += "\n    " + quoted(p.name) + ": " + (p.choices.empty() ? value_text(p) : quoted(value_text(p))) +
                (i + 1 < all.size() ? "," : "");
    }
    return text + "\n  }\n}\n";
}

} // namespace kokage

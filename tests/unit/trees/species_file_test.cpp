// Species files: those of the program, and a user's own with all that can be wrong in them.
#include "common/services/error.h"
#include "tests/support/temporary_folder.h"
#include "trees/species.h"

#include <fstream>
#include <gtest/gtest.h>

namespace kokage {
namespace {

std::string complaint_about(const std::string& text) {
    try {
        parse_species(text, "my.json");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string with_parameters(const std::string& parameters) {
    return R"({"name": "mine", "parameters": {)" + parameters + "}}";
}

void expect_same(const Species& a, const Species& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.latin_name, b.latin_name);
    EXPECT_EQ(a.summary, b.summary);
    EXPECT_EQ(a.sources, b.sources);
    EXPECT_EQ(a.parameters.species, b.parameters.species);
    const auto x = parameter_descriptions(a.parameters), y = parameter_descriptions(b.parameters);
    for (std::size_t i = 0; i < x.size(); ++i)
        EXPECT_EQ(x[i].value, y[i].value) << a.name << ": " << x[i].name;
}

TEST(SpeciesFile, TenSpeciesComeWithTheProgramEachWithNameSummaryAndSources) {
    std::vector<std::string> names;
    for (const Species& species : all_species()) {
        names.push_back(species.name);
        EXPECT_EQ(species.parameters.species, species.name);
        EXPECT_FALSE(species.latin_name.empty()) << species.name;
        EXPECT_FALSE(species.summary.empty()) << species.name;
        EXPECT_FALSE(species.sources.empty()) << species.name;
        EXPECT_NO_THROW(check_parameters(species.parameters));
    }
    EXPECT_EQ(names, (std::vector<std::string>{"aspen", "beech", "birch", "cherry", "cypress", "maple", "oak", "pine",
                                               "spruce", "willow"}));
}

TEST(SpeciesFile, WhatIsWrittenToStartFromReadsAsTheSameSpecies) {
    for (Species species : all_species()) {
        expect_same(species, parse_species(species_file_text(species), "written"));
        // Numbers without a short decimal form, too.
        species.parameters.seed = 9007199254740991u;
        species.parameters.leaf_length = 0.1 + 1e-17 + 1.0 / 3;
        species.summary = "a \"quoted\" back\\slash, \xC3\xBCmlaut";
        expect_same(species, parse_species(species_file_text(species), "written"));
    }
}

TEST(SpeciesFile, TakesCommentsAndNamesOfChoices) {
    const Species mine = parse_species("// mine\n{\"name\": \"mine\", /* here */ \"parameters\": {\"leaf_form\": "
                                       "\"alpha\", \"leaf_length\": 0.2}}",
                                       "my.json");
    EXPECT_EQ(mine.name, "mine");
    EXPECT_EQ(mine.parameters.leaf_form, LeafForm::alpha);
    EXPECT_EQ(mine.parameters.leaf_length, 0.2);
    EXPECT_EQ(mine.parameters.height_to_width, GrowthParameters{}.height_to_width) << "the default";
}

TEST(SpeciesFile, EveryMistakeIsOneLineThatNamesFileAndPlaceAndCure) {
    const std::vector<std::pair<std::string, std::string>> mistakes = {
        {with_parameters(R"("leaf_lenght": 0.1)"), "did you mean 'leaf_length'"},
        {with_parameters(R"("leaf_length": 7)"), "0.005 to 1 m"},
        {with_parameters(R"("leaf_length": -1e400)"), "too large"},
        {with_parameters(R"("leaf_length": "long")"), "0.005 to 1 m"},
        {with_parameters(R"("leaf_length": [0.1])"), "must be a number"},
        {with_parameters(R"("leaf_length": null)"), "must be a number"},
        {with_parameters(R"("leaves": 2.5)"), "a whole number"},
        {with_parameters(R"("leaf_form": 1)"), "outline or alpha"},
        {with_parameters(R"("leaf_form": "square")"), "outline or alpha"},
        {with_parameters(R"("leaf_length": 0.1, "leaf_length": 0.2)"), "twice"},
        {with_parameters(R"("a\nb": 1)"), "no growth parameter"},
        {R"({"name": "mine", "parameter": {}})", "did you mean 'parameters'"},
        {R"({"name": "mine", "parameters": []})", "'parameters' must be {"},
        {R"({"name": "mine", "sources": "x"})", "'sources' must be a list"},
        {R"({"name": "mine", "sources": [1]})", "'sources' must be a list"},
        {R"({"name": 5})", "'name' must be text"},
        {R"({"name": ""})", "'name' must be given"},
        {R"({"name": "a\u0000b"})", "one line"},
        {R"({"name": "mine", "summary": "two\nlines"})", "one line"},
        {R"({"parameters": {}})", "'name' must be given"},
        {"{\"name\": \"" + std::string(81, 'x') + "\"}", "1 to 80"},
        {"[]", "holds no {"},
        {"", "not JSON"},
        {"{\n\"name\": \"mine\"\n\"parameters\": {}}", "line 3"},
        {"{\"name\": \"\xFF\"}", "not JSON"},
        {"// only a comment", "not JSON"},
        {std::string(100000, '['), "not JSON"},
    };
    for (const auto& [text, expected] : mistakes) {
        const std::string complaint = complaint_about(text);
        EXPECT_EQ(complaint.rfind("my.json: ", 0), 0u) << text.substr(0, 80) << " -> " << complaint;
        EXPECT_NE(complaint.find(expected), std::string::npos) << text.substr(0, 80) << " -> " << complaint;
        EXPECT_EQ(complaint.find('\n'), std::string::npos) << complaint;
    }
}

TEST(SpeciesFile, FilesThatCantBeReadOrAreTooLargeAreRefused) {
    TemporaryFolder folder;
    EXPECT_THROW(read_species(folder / "none.json"), InputError);
    EXPECT_THROW(read_species(folder.path()), InputError);
    std::ofstream(folder / "large.json") << with_parameters("") << std::string(1 << 20, ' ');
    EXPECT_THROW(read_species(folder / "large.json"), InputError);
    std::ofstream(folder / "good.json") << with_parameters("");
    EXPECT_EQ(read_species(folder / "good.json").name, "mine");
}

} // namespace
} // namespace kokage

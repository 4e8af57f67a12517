// Damaged scene files: each is read, or gives one line. And what the schema says of them is what the reader says.
#include "common/services/random.h"
#include "tests/support/json_schema.h"
#include "tests/support/mutants.h"
#include "tests/support/scene_folder.h"
#include "viewer/scene/scene_texts.h"

#include <cstdlib>
#include <gtest/gtest.h>

namespace kokage {
namespace {
using Json = nlohmann::json;

int cases(int count) {
    const char* factor = std::getenv("KOKAGE_MUTANTS");
    return std::max(1, int(double(count) * (factor && *factor ? std::atof(factor) : 1.0)));
}

/// The complaint, after checks that it is fit for people; empty if the scene is read.
std::string fit_complaint(const SceneFolder& folder, const std::string& text) {
    try {
        folder.read(text);
        return "";
    } catch (const InputError& error) {
        const std::string said = error.what();
        EXPECT_EQ(said.find((folder / "scene.json").string() + ": "), 0u) << said << "\n" << text;
        EXPECT_EQ(said.find((folder / "scene.json").string(), 1), std::string::npos) << "named twice: " << said;
        EXPECT_LT(said.size(), 2000u) << said;
        EXPECT_EQ(said.find("exception"), std::string::npos) << said;
        return said;
    } catch (const std::exception& error) {
        ADD_FAILURE() << "not an InputError: " << error.what() << "\n" << text;
        return "?";
    }
}

TEST(MutatedScenes, AreReadOrRefusedInALine) {
    const SceneFolder folder;
    const std::string good = SceneFolder::good_scene().dump(1);
    Random random(11);
    int read = 0, refused = 0;
    for (int i = cases(4000); i > 0; --i)
        ++(fit_complaint(folder, mutant_of(good, good.size(), random)).empty() ? read : refused);
    std::printf("%d read, %d refused\n", read, refused);
    EXPECT_GT(read, 0);
    EXPECT_GT(refused, 0);
}

std::vector<Json::json_pointer> places_in(const Json& json) {
    std::vector<Json::json_pointer> places;
    const Json flat = json.flatten();
    for (const auto& [pointer, value] : flat.items())
        for (Json::json_pointer place(pointer); !place.empty(); place = place.parent_pointer())
            if (std::find(places.begin(), places.end(), place) == places.end())
                places.push_back(place);
    return places;
}

/// A value of any kind, or one that stands elsewhere in the scene.
Json some_value(const Json& scene, const std::vector<Json::json_pointer>& places, Random& random) {
    static const Json values = Json::parse(R"([0, 1, -1, 0.5, 2, 90, 91, 1e9, 1e31, 1e-9, -400, true, false, null, "",
        "sky", "oak", "y", "bark", "my.json", "pot.obj", "studio.hdr", "color.png", "x.txt", [], [1, 2], [1, 2, 3],
        [0.1, 0.2, 0.3], [1, "a"], {}, {"sky": {}}, {"albedo": 0.3}, {"constant": 1}, {"image": "studio.hdr"}, 3.7])");
    return random.below(3) == 0 ? scene[places[random.below(std::uint32_t(places.size()))]]
                                : values[random.below(std::uint32_t(values.size()))];
}

void mutate(Json& scene, Random& random) {
    static const std::vector<std::string> keys = [] {
        std::vector<std::string> all = {"colour", "x"};
        for (const Json::json_pointer& place : places_in(SceneFolder::good_scene()))
            all.push_back(place.back());
        for (const char* more : {"azimuth", "depth", "repeat", "sky", "constant", "size", "irradiance", "intensity"})
            all.emplace_back(more);
        return all;
    }();
    const std::vector<Json::json_pointer> places = places_in(scene);
    const Json::json_pointer place = places[random.below(std::uint32_t(places.size()))];
    Json& parent = scene[place.parent_pointer()];
    switch (random.below(3)) {
    case 0:
        if (parent.is_object())
            parent.erase(place.back());
        else
            parent.erase(std::size_t(std::stoul(place.back())));
        break;
    case 1: {
        const Json value = some_value(scene, places, random);
        if (parent.is_object())
            parent[keys[random.below(std::uint32_t(keys.size()))]] = value;
        else
            parent.push_back(value);
        break;
    }
    default:
        scene[place] = some_value(scene, places, random);
    }
}

/// What a schema can't know.
bool only_the_reader_knows(const std::string& complaint) {
    for (const char* part : {"there is no file", "is a folder", "no material is called", "is a scene; a scene can't",
                             "are the same place", "is given twice, beside 'set'", "(cyclic)"})
        if (complaint.find(part) != std::string::npos)
            return true;
    return false;
}

TEST(MutatedScenes, AreJudgedBySchemaAndReaderAlike) {
    const SceneFolder folder;
    const JsonSchema schema(Json::parse(scene_schema_text()));
    Random random(12);
    int read = 0, refused = 0, only_reader = 0;
    for (int i = cases(2000); i > 0; --i) {
        Json scene = SceneFolder::good_scene();
        for (std::uint32_t changes = 1 + random.below(2); changes > 0; --changes)
            mutate(scene, random);
        const std::string said = fit_complaint(folder, scene.dump());
        const bool accepted = schema.accepts(scene);
        if (accepted && !said.empty()) {
            EXPECT_TRUE(only_the_reader_knows(said)) << said << "\n" << scene.dump();
            ++only_reader;
        }
        if (said.empty()) {
            EXPECT_TRUE(accepted) << "read, but not by the schema: " << scene.dump();
        }
        ++(said.empty() ? read : refused);
    }
    std::printf("%d read, %d refused, %d of them for what a schema can't know\n", read, refused, only_reader);
    EXPECT_GT(read, 20);
    EXPECT_GT(refused, 20);
    EXPECT_GT(only_reader, 0);
}

} // namespace
} // namespace kokage

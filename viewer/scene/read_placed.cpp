// A scene file's trees and objects.
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/nearest_word.h"
#include "common/services/number_text.h"
#include "viewer/scene/scene_parts.h"

#include <nlohmann/json.hpp>

namespace kokage {
namespace fs = std::filesystem;
namespace {

constexpr double kFarthest = 10000;
constexpr std::uint64_t kLargestSpeciesFile = 1 << 20;

Placement read_placement(const JsonReader& json) {
    Placement placement;
    if (const auto at = json.find("at")) {
        std::vector<double> place;
        for (const JsonReader& part : at->elements(2, 3))
            place.push_back(part.number(-kFarthest, kFarthest));
        placement.at = place.size() == 2 ? glm::dvec3(place[0], 0, place[1]) : glm::dvec3(place[0], place[1], place[2]);
    }
    if (const auto turn = json.find("turn"))
        placement.turn_degrees = turn->number(-360, 360);
    if (const auto size = json.find("size"))
        placement.size = size->number(0.001, 1000);
    return placement;
}

/// Says where in the scene it was that something else complained.
template <typename Work>
void at(const JsonReader& json, Work&& work) {
    try {
        work();
    } catch (const InputError& error) {
        json.fail(error.what());
    }
}

/// What `value` sets, as text.
std::string setting_text(const std::string& name, const JsonReader& value, GrowthParameters& parameters) {
    if (!value.is_string()) {
        const double number = value.number(-1e300, 1e300);
        at(value, [&] { set_parameter(parameters, name, number); });
        return name + "=" + number_text(number);
    }
    const std::string text = value.text();
    at(value, [&] { set_parameter(parameters, name, std::string_view(text)); });
    for (const ParameterDescription& p : parameter_descriptions(parameters))
        if (p.name == name && p.choices.empty())
            value.fail("found \"" + text + "\" where a number is needed: " + range_text(p));
    return name + "=" + text;
}

void refuse_scenes(const JsonReader& name, const fs::path& file) {
    nlohmann::ordered_json json;
    at(name, [&] {
        const std::vector<unsigned char> bytes = read_file_bytes(file, kLargestSpeciesFile);
        json = parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string());
    });
    if (json.is_object() && json.contains("kokage_scene"))
        name.fail("'" + shown_name(name.text()) + "' is a scene; a scene can't be within a scene (it could be cyclic)");
}

void check_species(const JsonReader& name) {
    std::vector<std::string> names;
    std::string list;
    for (const Species& species : all_species()) {
        if (species.name == name.text())
            return;
        names.push_back(species.name);
        list += (list.empty() ? "" : ", ") + species.name;
    }
    const auto near = nearest_word(name.text(), names);
    name.fail("no species is called '" + shown_name(name.text()) + "'; " +
              (near ? "did you mean '" + *near + "'?" : "there are: " + list + ", or give a species file (.json)"));
}

void read_species_source(const JsonReader& json, const JsonReader& name, const SceneFiles& files, PlacedTree& tree) {
    for (const char* key : {"foliage", "leaf_size", "scale", "up"})
        if (const auto wrong = json.find(key))
            wrong->fail("'" + std::string(key) + "' is for trees of files ('file'); this one is grown ('species')");
    tree.source.name = name.text();
    if (lower_ending(tree.source.name) == ".json") {
        const fs::path file = files.find(name, {".json"});
        refuse_scenes(name, file);
        tree.source.name = file.string();
    } else {
        check_species(name);
    }
    at(name, [&] { asked_species(tree.source); });
    if (const auto leaves = json.find("leaves")) {
        tree.source.leaves = leaves->integer(1, kMostLeaves);
        at(*leaves, [&] { asked_species(tree.source); });
    }
    if (const auto seed = json.find("seed"))
        tree.seed = std::uint64_t(seed->integer(0, std::numeric_limits<int>::max()));
    if (const auto settings = json.find("set")) {
        for (const char* key : {"leaves", "seed"})
            if (json.find(key) && settings->find(key))
                settings->find(key)->fail("'" + std::string(key) + "' is given twice, beside 'set', too; keep one");
        GrowthParameters parameters = asked_species(tree.source).parameters;
        settings->for_each_member([&](const std::string& key, const JsonReader& value) {
            tree.source.settings.push_back(setting_text(key, value, parameters));
        });
    }
    at(json, [&] { check_tree_source(tree.source); });
}

void read_file_source(const JsonReader& json, const JsonReader& name, const SceneFiles& files, PlacedTree& tree) {
    for (const char* key : {"leaves", "seed", "set"})
        if (const auto wrong = json.find(key))
            wrong->fail("'" + std::string(key) + "' is for grown trees ('species'); this one is a file");
    tree.source.name = files.find(name, {".glb", ".gltf", ".obj"}).string();
    if (const auto foliage = json.find("foliage"))
        for (const JsonReader& one : foliage->elements(1, 1000))
            tree.source.foliage.push_back(one.text());
    if (const auto size = json.find("leaf_size"))
        tree.source.leaf_size = size->number(1e-6, kFarthest);
    if (const auto scale = json.find("scale"))
        tree.source.scale = scale->number(1e-6, 1e6);
    if (const auto up = json.find("up"))
        tree.source.up = up->choice({"y", "z"}) == 0 ? "y" : "z";
    at(json, [&] { check_tree_source(tree.source); });
}

} // namespace

PlacedTree read_placed_tree(const JsonReader& json, const SceneFiles& files) {
    json.check_keys({"species", "file", "leaves", "seed", "set", "foliage", "leaf_size", "scale", "up", "at", "turn",
                     "size", "leaf_material", "bark_material"});
    const auto species = json.find("species"), file = json.find("file");
    if (bool(species) == bool(file))
        json.fail(species ? "'species' and 'file' contradict one another; keep one of them"
                          : "'species' (a tree to grow) or 'file' (a tree's file) is missing");
    PlacedTree tree;
    tree.pointer = json.pointer();
    tree.placement = read_placement(json);
    if (species)
        read_species_source(json, *species, files, tree);
    else
        read_file_source(json, *file, files, tree);
    if (const auto material = json.find("leaf_material"))
        tree.leaf_material = material->text();
    if (const auto material = json.find("bark_material"))
        tree.bark_material = material->text();
    return tree;
}

PlacedObject read_placed_object(const JsonReader& json, const SceneFiles& files) {
    json.check_keys({"file", "up", "height", "at", "turn", "size", "material"});
    PlacedObject object;
    object.pointer = json.pointer();
    object.file = files.find(json.at("file"), {".glb", ".gltf", ".obj", ".stl"});
    object.placement = read_placement(json);
    if (const auto up = json.find("up"))
        object.up = up->choice({"y", "z"}) == 0 ? "y" : "z";
    if (const auto height = json.find("height")) {
        object.height_m = height->number(0.001, 1000);
        if (json.find("size"))
            height->fail("'height' and 'size' contradict one another; keep one of them");
    }
    if (const auto material = json.find("material"))
        object.material = material->text();
    return object;
}

} // namespace kokage

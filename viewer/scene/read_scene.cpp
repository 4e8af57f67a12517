#include "viewer/scene/read_scene.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/nearest_word.h"
#include "viewer/scene/scene_parts.h"

#include <nlohmann/json.hpp>
#include <set>

namespace kokage {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kLargestFile = 1 << 24;
constexpr std::size_t kMostThings = 10000, kMostLights = 1000;
constexpr const char* kHowToStart = "; 'kokage render --example' prints a scene that reads";

void check_version(const JsonReader& json) {
    const auto version = json.find("kokage_scene");
    if (!version)
        json.fail("'kokage_scene' is missing, so it is no scene; a scene begins {\"kokage_scene\": 1, ..." +
                  std::string(kHowToStart));
    if (!version->is_number() || version->number(-1e300, 1e300) != 1)
        version->fail("found " + version->found() + " where 1 is needed, the one version of scenes that is known");
}

/// Names of materials that trees and objects wear must stand in `materials`; those that stand there should be worn.
class WornMaterials {
  public:
    explicit WornMaterials(const SceneDescription& scene) : scene_(scene) {}

    /// `key`: of what wears it.
    void wear(const JsonReader& wearer, const char* key) {
        const auto name = wearer.find(key);
        if (!name)
            return;
        if (!scene_.materials.contains(name->text())) {
            std::vector<std::string> names;
            std::string list;
            for (const auto& [known, material] : scene_.materials) {
                names.push_back(known);
                list += (list.empty() ? "" : ", ") + shown_name(known);
            }
            const auto near = nearest_word(name->text(), names);
            name->fail("no material is called '" + shown_name(name->text()) + "'; " +
                       (near            ? "did you mean '" + shown_name(*near) + "'?"
                        : names.empty() ? "there is nothing in 'materials'"
                                        : "there are: " + list));
        }
        worn_.insert(name->text());
    }

    std::vector<std::string> warnings(const std::string& file) const {
        std::vector<std::string> result;
        for (const auto& [name, material] : scene_.materials)
            if (!worn_.contains(name))
                result.push_back(file + ": " + material.pointer +
                                 ": no tree and no object wears this material, so it changes nothing");
        return result;
    }

  private:
    const SceneDescription& scene_;
    std::set<std::string> worn_;
};

void read_materials(const JsonReader& json, const SceneFiles& files, SceneDescription& scene) {
    json.for_each_member([&](const std::string& name, const JsonReader& material) {
        if (name.empty() || name.size() > 200)
            json.fail("a material's name must have 1 to 200 letters");
        scene.materials.emplace(name, read_material(material, files));
    });
}

void read_things(const JsonReader& json, const SceneFiles& files, SceneDescription& scene) {
    WornMaterials materials(scene);
    if (const auto trees = json.find("trees"))
        for (const JsonReader& tree : trees->elements(0, kMostThings)) {
            scene.trees.push_back(read_placed_tree(tree, files));
            materials.wear(tree, "leaf_material");
            materials.wear(tree, "bark_material");
        }
    if (const auto objects = json.find("objects"))
        for (const JsonReader& object : objects->elements(0, kMostThings)) {
            scene.objects.push_back(read_placed_object(object, files));
            materials.wear(object, "material");
        }
    if (scene.trees.empty() && scene.objects.empty())
        json.fail("there is nothing to see: give 'trees' or 'objects', such as \"trees\": [{\"species\": \"oak\"}]");
    scene.warnings = materials.warnings(scene.file.string());
}

} // namespace

SceneDescription read_scene(const fs::path& file, const fs::path& data) {
    std::error_code ignored;
    if (fs::is_directory(file, ignored))
        throw InputError("'" + file.string() + "' is a folder; give a scene file (.json)");
    const std::vector<unsigned char> bytes = read_file_bytes(file, kLargestFile);
    const auto parsed =
        parse_json({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string(), kHowToStart);
    const JsonReader json(parsed, file.string());
    if (!json.is_object())
        json.fail("it holds no object { }" + std::string(kHowToStart));
    check_version(json);
    json.check_keys({"$schema", "kokage_scene", "environment", "lights", "ground", "materials", "trees", "objects",
                     "camera", "output"});
    const SceneFiles files(file, data);
    SceneDescription scene;
    scene.name = file.stem().string();
    scene.file = file;
    scene.surroundings.words = {.environment = "/environment",
                                .sun = "/environment/sky/sun",
                                .lights = "/lights",
                                .no_ground = "\"ground\": false",
                                .exposure = "'exposure' in 'output'"};
    if (const auto schema = json.find("$schema"))
        schema->text();
    if (const auto environment = json.find("environment"))
        read_environment(*environment, files, scene);
    if (const auto lights = json.find("lights"))
        for (const JsonReader& light : lights->elements(0, kMostLights))
            scene.surroundings.lights.push_back(read_light(light));
    if (const auto ground = json.find("ground"))
        read_ground(*ground, scene.surroundings);
    if (scene.surroundings.ground == false)
        scene.picture.ground = PictureGround::none;
    if (const auto materials = json.find("materials"))
        read_materials(*materials, files, scene);
    read_things(json, files, scene);
    if (const auto camera = json.find("camera"))
        scene.camera = read_camera(*camera);
    if (const auto output = json.find("output"))
        read_output(*output, scene.picture);
    check_surroundings(scene.surroundings);
    return scene;
}

SceneDescription scene_of_tree(const TreeSource& tree) {
    SceneDescription scene;
    scene.name = tree.stem();
    scene.trees.push_back(
        {.source = tree, .seed = {}, .placement = {}, .leaf_material = "", .bark_material = "", .pointer = ""});
    return scene;
}

} // namespace kokage

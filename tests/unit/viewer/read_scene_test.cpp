// Scene files: what is read from them, and what is said of bad ones.
#include "tests/support/json_schema.h"
#include "tests/support/scene_folder.h"
#include "viewer/scene/scene_texts.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {
using Json = nlohmann::json;

TEST(ReadScene, ReadsAllThatAScenesCanSay) {
    const SceneFolder folder;
    const SceneDescription scene = folder.read(SceneFolder::good_scene().dump());
    EXPECT_EQ(scene.name, "scene");
    EXPECT_EQ(scene.surroundings.environment, (folder / "studio.hdr").string());
    EXPECT_EQ(scene.environment_turn_degrees, 90);
    EXPECT_TRUE(scene.surroundings.strict);
    EXPECT_EQ(scene.surroundings.lights,
              std::vector<std::string>(
                  {"sun:220,30,9,8.5,7", "disc:10,60,2,2,2,4", "directional:0,-20,0.5,0.5,0.5", "point:2,3,1,5,4,3"}));
    EXPECT_EQ(scene.surroundings.ground, true);
    ASSERT_EQ(scene.materials.size(), 3u);
    const MaterialDescription& bark = scene.materials.at("bark");
    EXPECT_EQ(bark.roughness, 0.8);
    EXPECT_EQ(bark.roughness_texture, folder / "rough.jpg");
    EXPECT_EQ(bark.metallic, 0);
    EXPECT_FALSE(bark.base_color || bark.index_of_refraction || bark.roughness_from_foot_to_top);
    EXPECT_EQ(bark.relief.value().heights, folder / "heights.png");
    EXPECT_EQ(bark.relief->depth_m, 0.02);
    EXPECT_EQ(bark.pointer, "/materials/bark");
    EXPECT_EQ(scene.materials.at("leaf").relief.value().depth_m, 0);
    const MaterialDescription& glaze = scene.materials.at("glaze");
    EXPECT_EQ(glaze.base_color, glm::vec3(0.1f, 0.2f, 0.6f));
    EXPECT_EQ(glaze.roughness_from_foot_to_top, glm::dvec2(0.15, 0.7));
    EXPECT_EQ(glaze.relief.value().repeat_m, 0.5);
    ASSERT_EQ(scene.trees.size(), 3u);
    const PlacedTree& oak = scene.trees[0];
    EXPECT_EQ(oak.source.name, "oak");
    EXPECT_EQ(oak.source.leaves, 3000);
    EXPECT_EQ(oak.seed, 4u);
    EXPECT_EQ(oak.source.settings, std::vector<std::string>({"branch_angle=50.5", "season=autumn"}));
    EXPECT_EQ(oak.placement.at, glm::dvec3(1, 0, -2));
    EXPECT_EQ(oak.placement.turn_degrees, 30);
    EXPECT_EQ(oak.placement.size, 1.5);
    EXPECT_EQ(oak.leaf_material, "leaf");
    EXPECT_EQ(oak.bark_material, "bark");
    EXPECT_EQ(asked_species(scene.trees[1].source).name, "my birch");
    const PlacedTree& file = scene.trees[2];
    EXPECT_EQ(file.source.name, (folder / "tree.glb").string());
    EXPECT_EQ(file.source.foliage, std::vector<std::string>({"Leaves"}));
    EXPECT_EQ(file.source.leaf_size, 0.1);
    EXPECT_EQ(file.source.scale, 0.01);
    EXPECT_EQ(file.source.up, "z");
    EXPECT_EQ(file.placement.at, glm::dvec3(4, 0.5, 3));
    ASSERT_EQ(scene.objects.size(), 2u);
    EXPECT_EQ(scene.objects[0].height_m, 0.4);
    EXPECT_EQ(scene.objects[0].material, "glaze");
    EXPECT_EQ(scene.objects[1].placement.size, 0.001);
    EXPECT_EQ(scene.camera.target, glm::dvec3(0, 3, 0));
    EXPECT_EQ(scene.camera.vertical_field_of_view_degrees, 40);
    EXPECT_EQ(scene.picture.width, 640);
    EXPECT_EQ(scene.picture.samples, 32);
    EXPECT_EQ(scene.picture.exposure_stops, -0.5f);
    EXPECT_EQ(scene.picture.seed, 7u);
    EXPECT_TRUE(scene.warnings.empty());
}

TEST(ReadScene, ReliefIsScaledOrLeftOut) {
    const SceneFolder folder;
    nlohmann::json text = SceneFolder::good_scene();
    text["materials"]["bark"]["relief"] = false;
    text["materials"]["leaf"]["relief"] = {{"scale", 2.5}};
    const SceneDescription scene = folder.read(text.dump());
    EXPECT_TRUE(scene.materials.at("bark").relief.value().none);
    EXPECT_EQ(scene.materials.at("leaf").relief.value().scale, 2.5);
    EXPECT_FALSE(scene.materials.at("leaf").relief->none);
}

TEST(ReadScene, KnowsEnvironmentsByWordsAndByKind) {
    const SceneFolder folder;
    const auto with = [&](const char* environment) {
        Json scene = Json::parse(R"({"kokage_scene": 1, "trees": [{"species": "oak"}]})");
        scene["environment"] = Json::parse(environment);
        return folder.read(scene.dump()).surroundings;
    };
    EXPECT_EQ(with(R"("sky")").environment, "sky");
    EXPECT_EQ(with(R"("studio.hdr")").environment, (folder / "studio.hdr").string());
    EXPECT_EQ(with(R"({"sky": {"sun": [265.5, -4], "turbidity": 4}})").sun, "265.5,-4");
    EXPECT_EQ(with(R"({"sky": {"turbidity": 4}})").turbidity, 4);
    EXPECT_EQ(with(R"({"constant": 2})").environment, "constant:2,2,2");
    EXPECT_EQ(with(R"({"gradient": {"zenith": [1, 2, 3], "horizon": 4, "nadir": 0}})").environment,
              "gradient:1,2,3,4,4,4,0,0,0");
}

TEST(ReadScene, LooksForFilesInTheDataFolderToo) {
    const SceneFolder folder, data;
    std::filesystem::create_directories(data / "objects");
    data.write("objects/jug.obj", "");
    const std::string scene = R"({"kokage_scene": 1, "objects": [{"file": "jug.obj"}]})";
    EXPECT_EQ(folder.read(scene, data / "").objects.at(0).file, data / "objects/jug.obj");
    EXPECT_NE(folder.complaint(scene).find("--data FOLDER"), std::string::npos);
    EXPECT_THROW(folder.read(scene, data / "nowhere"), InputError);
}

TEST(ReadScene, WarnsOfMaterialsThatNobodyWears) {
    const SceneFolder folder;
    const SceneDescription scene =
        folder.read(R"({"kokage_scene": 1, "materials": {"a/b": {}}, "trees": [{"species": "oak"}]})");
    ASSERT_EQ(scene.warnings.size(), 1u);
    EXPECT_NE(scene.warnings[0].find("scene.json: /materials/a~1b: no tree and no object wears"), std::string::npos);
}

/// The good scene with one value replaced (or, without a value, taken away), and what is said then.
struct Mutation {
    const char *pointer, *value, *complaint;
};

void expect_refusals(const std::vector<Mutation>& mutations) {
    const SceneFolder folder;
    for (const Mutation& mutation : mutations) {
        Json scene = SceneFolder::good_scene();
        const Json::json_pointer pointer(mutation.pointer);
        if (mutation.value)
            scene[pointer] = Json::parse(mutation.value);
        else
            scene[pointer.parent_pointer()].erase(pointer.back());
        const std::string said = folder.complaint(scene.dump());
        EXPECT_EQ(said.find((folder / "scene.json").string() + ": "), 0u) << mutation.pointer << ": " << said;
        EXPECT_NE(said.find(mutation.complaint), std::string::npos)
            << mutation.pointer << " = " << (mutation.value ? mutation.value : "nothing") << ": " << said;
    }
}

TEST(ReadScene, RefusesBadLightAndGround) {
    expect_refusals({
        {"/kokage_scene", nullptr, "'kokage_scene' is missing, so it is no scene"},
        {"/kokage_scene", "2", "/kokage_scene: found 2 where 1 is needed"},
        {"/kokage_scene", "\"1\"", "/kokage_scene: found \"1\" where 1 is needed"},
        {"/$schema", "3", "/$schema: found 3 where text in quotes is needed"},
        {"/enviroment", "\"sky\"", "nothing is called 'enviroment' here; did you mean 'environment'?"},
        {"/zzzzzz", "1", "nothing is called 'zzzzzz' here; there are: $schema, kokage_scene, environment"},
        {"/environment", "7", "/environment: found 7 where an object { } is needed, with: sky, image"},
        {"/environment", "\"constant\"", "/environment: 'constant' needs its colours: {\"constant\": 1} or"},
        {"/environment", "\"studoi.hdr\"", "/environment: there is no file 'studoi.hdr' beside the scene"},
        {"/environment/image", "\"studoi.hdr\"", "; did you mean 'studio.hdr'?"},
        {"/environment/image", "\"folder.png\"", "/environment/image: 'folder.png' is a folder; give a file (.hdr"},
        {"/environment/image", "\"sky\"", "'sky' has no ending; give a file of one of these endings: .hdr, .exr, .png"},
        {"/environment/image", "\"tree.glb\"", "'tree.glb' ends in .glb; give a file"},
        {"/environment/image", nullptr, "/environment: it does not say what it is: one of these is missing: sky"},
        {"/environment/sky", "{}", "/environment: 'sky' and 'image' contradict one another"},
        {"/environment", R"({"sky": {}, "turn": 3})", "/environment/turn: 'turn' is for images"},
        {"/environment", R"({"sky": {"sun": [0, 91]}})",
         "/environment/sky/sun/1: found 91 where a number from -90 to 90"},
        {"/environment", R"({"sky": {"sun": [0]}})", "found a list of 1 where a list [ ] of 2 is needed"},
        {"/environment", R"({"constant": -1})", "/environment/constant: found -1 where a number from 0"},
        {"/environment", R"({"gradient": {"zenith": 1, "nadir": 1}})", "/environment/gradient: 'horizon' is missing"},
        {"/environment/turn", "true", "/environment/turn: found true where a number from -360 to 360 is needed"},
        {"/environment/strict", "1", "/environment/strict: found 1 where true or false is needed"},
        {"/lights", "{}", "/lights: found an object { } where a list [ ] of 0 to 1000 is needed"},
        {"/lights/0/sun", nullptr, "/lights/0: it does not say what it is"},
        {"/lights/0/irradiance", nullptr, "/lights/0: 'irradiance' is missing"},
        {"/lights/0/intensity", "1", "/lights/0/intensity: a light of kind 'sun' has 'irradiance' in place of"},
        {"/lights/0/half_angle", "1", "/lights/0/half_angle: 'half_angle' is for lights of kind 'disc'"},
        {"/lights/1/half_angle", "0", "/lights/1/half_angle: found 0 where a number from 0.001 to 90"},
        {"/lights/3/point", "[1, 2, 1e9]", "/lights/3/point/2: found 1000000000.0 where a number from -1000000"},
        {"/ground", "3", "/ground: found 3 where an object { } is needed, with: albedo"},
        {"/ground/albedo", "1.5", "/ground/albedo: found 1.5 where a number from 0 to 1"},
        {"/ground/albedo", "null",
         "/ground/albedo: found null where a number (a grey) or a list [ ] of 3, each from 0 to 1"},
        {"/lights/0/irradiance", "-1", "/lights/0/irradiance: found -1 where a number from 0 to 1e+30 is needed"},
        {"/ground/albedo/1", "\"green\"", "/ground/albedo/1: found \"green\" where a number from 0 to 1"},
    });
}

TEST(ReadScene, RefusesBadMaterials) {
    expect_refusals({
        {"/materials", "[]", "/materials: found a list of 0 where an object { } is needed"},
        {"/materials/bark", "3", "/materials/bark: found 3 where an object { } is needed, with: base_color,"},
        {"/materials/", "{}", "/materials: a material's name must have 1 to 200 letters"},
        {"/materials/bark/rougness", "1",
         "/materials/bark/rougness: nothing is called 'rougness' here; did you mean 'roughness'? There are: "
         "base_color"},
        {"/materials/bark/roughness", "1.01", "/materials/bark/roughness: found 1.01 where a number from 0 to 1"},
        {"/materials/bark/roughness_texture", "\"none.png\"", "/materials/bark/roughness_texture: there is no file"},
        {"/materials/bark/roughness_texture", "\"folder.png\"", "'folder.png' is a folder"},
        {"/materials/glaze/roughness", "0.5",
         "/materials/glaze/roughness_from_foot_to_top: 'roughness_from_foot_to_top'"},
        {"/materials/glaze/roughness_from_foot_to_top", "[0.1]", "found a list of 1 where a list [ ] of 2 is needed"},
        {"/materials/glaze/base_color", "[1, 1, 2]",
         "/materials/glaze/base_color/2: found 2 where a number from 0 to 1"},
        {"/materials/leaf/index_of_refraction", "0",
         "/materials/leaf/index_of_refraction: found 0 where a number from 1"},
        {"/materials/bark/metallic", "\"yes\"", "/materials/bark/metallic: found \"yes\" where a number"},
        {"/materials/bark/relief/normals", "\"normals.png\"", "'heights' and 'normals' contradict one another"},
        {"/materials/bark/relief/depth", nullptr, "/materials/bark/relief: 'heights' needs 'depth'"},
        {"/materials/bark/relief/depth", "0", "/materials/bark/relief/depth: found 0 where a number from"},
        {"/materials/glaze/relief/repeat", nullptr, "/materials/glaze/relief: 'normals' needs 'depth'"},
        {"/materials/glaze/relief/depth", "0.1", "/materials/glaze/relief/repeat: 'repeat' and 'depth' contradict"},
        {"/materials/bark/relief", "true", "/materials/bark/relief: found true where false (none) or an object"},
        {"/materials/bark/relief", "0", "/materials/bark/relief: found 0 where an object { } is needed"},
        {"/materials/bark/relief/scale", "2", "/materials/bark/relief/scale: 'scale' makes the bark's own relief"},
        {"/materials/leaf/relief/scale", "0", "/materials/leaf/relief/scale: found 0 where a number from 0.01"},
        {"/materials/leaf/relief", R"({"scale": 2, "depth": 1})", "/materials/leaf/relief/scale: 'scale' makes"},
        {"/materials/leaf/relief/repeat", "1", "/materials/leaf/relief/repeat: 'repeat' gives 'normals' a scale"},
        {"/trees/0/leaf_material", "\"laef\"",
         "/trees/0/leaf_material: no material is called 'laef'; did you mean 'leaf'?"},
        {"/objects/0/material", "\"qqqqq\"",
         "/objects/0/material: no material is called 'qqqqq'; there are: bark, glaze"},
        {"/materials", nullptr,
         "/trees/0/leaf_material: no material is called 'leaf'; there is nothing in 'materials'"},
    });
}

TEST(ReadScene, RefusesBadTreesAndObjects) {
    expect_refusals({
        {"/trees", "{}", "/trees: found an object { } where a list [ ] of 0 to 10000 is needed"},
        {"/trees/0", "\"oak\"", "/trees/0: found \"oak\" where an object { } is needed, with: species, file"},
        {"/trees/0/species", nullptr, "/trees/0: 'species' (a tree to grow) or 'file' (a tree's file) is missing"},
        {"/trees/0/file", "\"tree.glb\"", "/trees/0: 'species' and 'file' contradict one another"},
        {"/trees/0/species", "\"oack\"", "/trees/0/species: no species is called 'oack'; did you mean 'oak'?"},
        {"/trees/0/species", "\"wxyzwxyz\"", "there are: aspen, beech, birch"},
        {"/trees/0/species", "\"none.json\"", "/trees/0/species: there is no file 'none.json'"},
        {"/trees/1/species", "\"scene.json\"", "/trees/1/species: 'scene.json' is this scene itself (cyclic)"},
        {"/trees/1/species", "\"./scene.json\"", "is this scene itself (cyclic)"},
        {"/trees/1/species", "\"other.json\"", "/trees/1/species: 'other.json' is a scene; a scene can't be within"},
        {"/trees/2/file", "\"scene.json\"", "/trees/2/file: 'scene.json' ends in .json; give a file"},
        {"/trees/0/leaves", "0", "/trees/0/leaves: found 0 where a whole number from 1 to 2000000"},
        {"/trees/0/leaves", "12.5", "/trees/0/leaves: found 12.5 where a whole number"},
        {"/trees/0/leaves", "1e12", "/trees/0/leaves: found 1000000000000.0 where a whole number"},
        {"/trees/0/seed", "-1", "/trees/0/seed: found -1 where a whole number from 0"},
        {"/trees/0/seed", "1.5", "/trees/0/seed: found 1.5 where a whole number from 0"},
        {"/trees/0/set/branch_angel", "3",
         "/trees/0/set/branch_angel: no growth parameter is called 'branch_angel'; did"},
        {"/trees/0/set/branch_angle", "1e5", "/trees/0/set/branch_angle: branch_angle = 100000 is out of range"},
        {"/trees/0/set/branch_angle", "\"50\"", "/trees/0/set/branch_angle: found \"50\" where a number is needed"},
        {"/trees/0/set/season", "\"noon\"", "/trees/0/set/season: season = 'noon' can't be read; it takes"},
        {"/trees/0/set/season", "true", "/trees/0/set/season: found true where a number"},
        {"/trees/0/set/seed", "3", "/trees/0/set/seed: 'seed' is given twice, beside 'set', too"},
        {"/trees/0/set", "[]", "/trees/0/set: found a list of 0 where an object { } is needed"},
        {"/trees/0/foliage", "[\"x\"]", "/trees/0/foliage: 'foliage' is for trees of files"},
        {"/trees/2/leaves", "10", "/trees/2/leaves: 'leaves' is for grown trees"},
        {"/trees/2/scale", "0", "/trees/2/scale: found 0 where a number from"},
        {"/trees/2/up", "\"x\"", "/trees/2/up: found \"x\" where one of these is needed: y, z"},
        {"/trees/2/foliage", "[]", "/trees/2/foliage: found a list of 0 where a list [ ] of 1 to 1000"},
        {"/trees/0/at", "[1]", "/trees/0/at: found a list of 1 where a list [ ] of 2 to 3 is needed"},
        {"/trees/0/at", "[1, 2, 3, 4]", "/trees/0/at: found a list of 4"},
        {"/trees/0/at/0", "1e300", "/trees/0/at/0: found 1e+300 where a number from -10000 to 10000"},
        {"/trees/0/size", "0", "/trees/0/size: found 0 where a number from 0.001 to 1000"},
        {"/trees/0/turn", "null", "/trees/0/turn: found null where a number"},
        {"/objects/0/file", nullptr, "/objects/0: 'file' is missing"},
        {"/objects/0/file", "\"pot.fbx\"", "/objects/0/file: 'pot.fbx' ends in .fbx; give a file of one of these"},
        {"/objects/0/file", "\"\"", "/objects/0/file: found \"\" where one line of text"},
        {"/objects/0/size", "2", "/objects/0/height: 'height' and 'size' contradict one another"},
        {"/objects/1/species", "\"oak\"", "/objects/1/species: nothing is called 'species' here; there are: file, up"},
    });
}

TEST(ReadScene, RefusesBadViews) {
    expect_refusals({
        {"/camera/target", nullptr, "/camera: 'position' is given without 'target'; give both, or neither"},
        {"/camera/position", nullptr, "/camera: 'target' is given without 'position'"},
        {"/camera/position", "[0, 3, 0]", "/camera: 'position' and 'target' are the same place"},
        {"/camera/azimuth", "30", "/camera/azimuth: 'azimuth' turns the camera that is placed by itself"},
        {"/camera/field_of_view", "180", "/camera/field_of_view: found 180 where a number from 0.1 to 150"},
        {"/camera/position", "[0, 1]", "/camera/position: found a list of 2 where a list [ ] of 3"},
        {"/output/size", "[0, 480]", "/output/size/0: found 0 where a whole number from 1 to 32768"},
        {"/output/size", "\"640x480\"", "/output/size: found \"640x480\" where a list [ ] of 2"},
        {"/output/samples", "1e9", "/output/samples: found 1000000000.0 where a whole number from 1 to 65536"},
        {"/output/exposure", "1e4", "/output/exposure: found 10000.0 where a number from -100 to 100"},
        {"/output/file", "\"a.png\"", "/output/file: nothing is called 'file' here"},
    });
}

TEST(ReadScene, RefusesWhatIsNoScene) {
    const SceneFolder folder;
    const std::pair<std::string, const char*> cases[] = {
        {"", "not JSON"},
        {"{\"kokage_scene\": 1,", "line 1, column"},
        {"[1, 2]", "it holds no object { }"},
        {"{}", "'kokage_scene' is missing"},
        {R"({"kokage_scene": 1})", "there is nothing to see: give 'trees' or 'objects'"},
        {R"({"kokage_scene": 1, "trees": [], "objects": []})", "there is nothing to see"},
        {R"({"kokage_scene": 1, "trees": [{"species": "oak", "at": [1e999, 0]}]})",
         ": /trees/0/at/0: found 1e999, which is too large"},
        {R"({"kokage_scene": 1, "trees": [{"species": "oak", "at": [0, -1e400]}]})",
         ": /trees/0/at/1: found -1e400, which is too large"},
        {R"({"kokage_scene": 1, "camera": {"field_of_view": 1e999}})",
         ": /camera/field_of_view: found 1e999, which is too large"},
        {"1e999", ": found 1e999, which is too large"},
        {R"({"kokage_scene": 1, "trees": [{"species": "oak", "turn": NaN}]})", "not JSON"},
        {R"({"kokage_scene": 1, "trees": [{"species": "oak"}], "trees": []})", ": /trees: 'trees' stands there twice"},
        {R"({"kokage_scene": 1, "trees": [{}, {"at": [1, 2], "turn": 1, "turn": 2}]})",
         ": /trees/1/turn: 'turn' stands there twice"},
        {std::string(1 << 16, '['), "not JSON"},
    };
    for (const auto& [text, complaint] : cases) {
        const std::string said = folder.complaint(text);
        EXPECT_NE(said.find(complaint), std::string::npos) << text.substr(0, 80) << ": " << said;
        EXPECT_EQ(said.find((folder / "scene.json").string() + ": "), 0u) << said;
    }
    EXPECT_THROW(read_scene(folder / ""), InputError);
    EXPECT_THROW(read_scene(folder / "none.json"), InputError);
}

TEST(ReadScene, AllowsComments) {
    const SceneFolder folder;
    EXPECT_EQ(folder.complaint("// one\n{\"kokage_scene\": 1, /* two */ \"trees\": [{\"species\": \"oak\"}]}"), "");
}

// Schema and reader.

TEST(SceneSchema, AcceptsTheExampleAsTheReaderDoes) {
    const JsonSchema schema(Json::parse(scene_schema_text()));
    const std::string example(scene_example_text());
    EXPECT_TRUE(schema.accepts(Json::parse(example, nullptr, true, true)));
    const SceneFolder folder;
    EXPECT_EQ(folder.complaint(example), "");
    EXPECT_TRUE(folder.read(example).warnings.empty());
    EXPECT_TRUE(schema.accepts(SceneFolder::good_scene()));
}

TEST(SceneSchema, AcceptsTheSceneThatIsDocumented) {
    const std::string readme = read_text(std::filesystem::path(KOKAGE_TESTS_FOLDER) / "../viewer/scene/README.md");
    const std::string fence = "```json\n";
    const std::size_t begin = readme.find(fence), end = readme.find("```", begin + fence.size());
    ASSERT_NE(end, std::string::npos);
    const Json scene =
        Json::parse(readme.substr(begin + fence.size(), end - begin - fence.size()), nullptr, true, true);
    const JsonSchema schema(Json::parse(scene_schema_text()));
    EXPECT_TRUE(schema.accepts(scene));
    for (const auto& [key, rule] : schema.root()["properties"].items())
        EXPECT_TRUE(scene.contains(key)) << key;
}

TEST(SceneSchema, AcceptsTheScenesOfTheGalleryAsTheReaderDoes) {
    // Files that are no part of the repository, where the data folder would have them.
    const TemporaryFolder data(parent_in_memory());
    for (const std::string file : {"env/sky_clouds_sun.hdr", "env/studio_small_03.hdr", "objects/utah_teapot.obj"}) {
        std::filesystem::create_directories((data / file).parent_path());
        std::ofstream(data / file) << "";
    }
    const JsonSchema schema(Json::parse(scene_schema_text()));
    int scenes = 0;
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(KOKAGE_TESTS_FOLDER) / "../viewer/pictures/scenes"))
        if (entry.path().extension() == ".json") {
            ++scenes;
            EXPECT_TRUE(schema.accepts(Json::parse(read_text(entry.path())))) << entry.path();
            EXPECT_NO_THROW(EXPECT_TRUE(read_scene(entry.path(), data / "").warnings.empty())) << entry.path();
        }
    EXPECT_EQ(scenes, 7);
}

TEST(SceneSchema, TellsEveryGrowthParameterAndSpecies) {
    const Json schema = Json::parse(scene_schema_text());
    const Json& growth = schema["definitions"]["growth"]["properties"];
    const std::vector<ParameterDescription> parameters = parameter_descriptions({});
    EXPECT_EQ(growth.size(), parameters.size());
    for (const ParameterDescription& p : parameters) {
        ASSERT_TRUE(growth.contains(p.name)) << p.name;
        const Json& told = growth[p.name];
        EXPECT_EQ(told["description"], p.meaning + (p.unit.empty() ? "" : " (" + p.unit + ")"));
        if (p.choices.empty()) {
            EXPECT_EQ(told["type"], p.whole ? "integer" : "number") << p.name;
            EXPECT_EQ(told["minimum"], p.low) << p.name;
            EXPECT_EQ(told["maximum"], p.high) << p.name;
            if (const Json& of_tree = schema["definitions"]["tree"]["properties"]; of_tree.contains(p.name)) {
                EXPECT_EQ(of_tree[p.name]["minimum"], p.low) << p.name;
                EXPECT_EQ(of_tree[p.name]["maximum"], std::min(p.high, 2147483647.)) << p.name;
            }
        } else {
            EXPECT_EQ(told["enum"], Json(p.choices)) << p.name;
        }
    }
    Json names = Json::array();
    for (const Species& species : all_species())
        names.push_back(species.name);
    EXPECT_EQ(schema["definitions"]["tree"]["properties"]["species"]["anyOf"][0]["enum"], names);
}

/// Every object of the schema that takes no other keys.
void for_each_closed_object(const Json& schema, const std::function<void(const Json&)>& visit) {
    if (schema.is_object() && schema.value("type", "") == "object" && schema.contains("properties") &&
        schema.value("additionalProperties", Json()) == Json(false))
        visit(schema);
    if (schema.is_structured())
        for (const Json& inner : schema)
            for_each_closed_object(inner, visit);
}

TEST(SceneSchema, DescribesEveryKey) {
    int keys = 0;
    for_each_closed_object(Json::parse(scene_schema_text()), [&](const Json& object) {
        for (const auto& [key, rule] : object["properties"].items()) {
            ++keys;
            const bool told = rule.contains("description") || rule.contains("$ref") || rule.contains("enum");
            EXPECT_TRUE(told) << key;
        }
    });
    EXPECT_GT(keys, 100);
}

} // namespace
} // namespace kokage

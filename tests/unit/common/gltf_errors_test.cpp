// Files that are wrong: one line that names file, place and cause, before memory is taken for what they claim to hold.
#include "common/gltf/gltf_scene.h"

#include "common/services/error.h"
#include "tests/support/gltf_text.h"
#include "tests/support/program_run.h"

#include <functional>
#include <gtest/gtest.h>

namespace kokage {
namespace {

std::string file_complaint(const GltfText& file) {
    TemporaryFolder folder;
    file.write(folder / "scene.gltf");
    try {
        flatten(GltfDocument::read(folder / "scene.gltf"));
    } catch (const InputError& error) {
        const std::string what = error.what();
        EXPECT_EQ(what.find((folder / "scene.gltf").string()), 0u) << what;
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        return what;
    }
    return "";
}

GltfText good_file() {
    GltfText file = GltfText::triangle();
    file.json["meshes"][0]["primitives"][0]["indices"] = file.indices({0, 1, 2});
    file.node({{"mesh", 0}});
    file.scene({0});
    return file;
}

struct Case {
    const char* what;
    std::function<void(GltfText&)> spoil;
    const char* says;
};

TEST(GltfErrors, AreOneLineThatNamesTheCause) {
    ASSERT_EQ(file_complaint(good_file()), "");
    const std::vector<Case> cases = {
        {"an unknown required extension", [](GltfText& f) { f.json["extensionsRequired"] = {"EXT_of_tomorrow"}; },
         "EXT_of_tomorrow"},
        {"Draco that is damaged",
         [](GltfText& f) {
             f.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
         },
         "its Draco data is damaged; export"},
        {"meshopt without a length",
         [](GltfText& f) {
             f.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0}};
         },
         "bufferView 0: its meshopt data is not within its buffer"},
        {"an index out of range", [](GltfText& f) { f.bytes[f.bytes.size() - 2] = 77; }, "names vertex 77 of 3"},
        {"a view beyond its buffer", [](GltfText& f) { f.json["bufferViews"][0]["byteLength"] = 4000000000u; },
         "bufferView 0"},
        {"a view of another buffer", [](GltfText& f) { f.json["bufferViews"][0]["buffer"] = 3; }, "buffer 3"},
        {"a negative offset", [](GltfText& f) { f.json["bufferViews"][0]["byteOffset"] = -4; }, "byteOffset"},
        {"a count beyond the view", [](GltfText& f) { f.json["accessors"][0]["count"] = 4; }, "accessor 0"},
        {"a count beyond memory", [](GltfText& f) { f.json["accessors"][0]["count"] = 4000000000000u; }, "accessor 0"},
        {"a count of zeros beyond memory",
         [](GltfText& f) {
             f.json["accessors"][0].erase("bufferView");
             f.json["accessors"][0]["count"] = 100000000;
         },
         "accessor 0"},
        {"an accessor that is not there",
         [](GltfText& f) { f.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 9; }, "accessor 9"},
        {"a node that is not there", [](GltfText& f) { f.json["scenes"][0]["nodes"] = {5}; }, "node 5"},
        {"a mesh that is not there", [](GltfText& f) { f.json["nodes"][0]["mesh"] = 5; }, "mesh 5"},
        {"a material that is not there", [](GltfText& f) { f.json["meshes"][0]["primitives"][0]["material"] = 5; },
         "material 5"},
        {"a node cycle",
         [](GltfText& f) {
             f.json["nodes"] = {{{"mesh", 0}, {"children", {1}}}, {{"children", {0}}}};
         },
         "cycle"},
        {"a child of two nodes",
         [](GltfText& f) {
             f.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
             f.json["scenes"][0]["nodes"] = {0, 1};
         },
         "child of two"},
        {"a position that is not a number",
         [](GltfText& f) {
             const std::uint32_t nan = 0x7fc00000;
             std::memcpy(f.bytes.data() + 4, &nan, 4);
         },
         "vertex 0"},
        {"a transform that is not finite",
         [](GltfText& f) {
             f.json["nodes"][0]["scale"] = {1e300, 1e300, 1e300};
         },
         ""},
        {"a negative count", [](GltfText& f) { f.json["accessors"][1]["count"] = -1; }, "accessor 1: \"count\" is -1"},
        {"a mode that glTF doesn't have", [](GltfText& f) { f.json["meshes"][0]["primitives"][0]["mode"] = 9; },
         "mode 9"},
        {"version 1", [](GltfText& f) { f.json["asset"]["version"] = "1.0"; }, "version 1.0; version 2 is needed"},
        {"objects by name, as version 1 has them",
         [](GltfText& f) {
             f.json["meshes"] = {{"tree", {{"primitives", nlohmann::json::array()}}}};
         },
         "version 2 is needed"},
        {"no mesh", [](GltfText& f) { f.json["nodes"][0].erase("mesh"); }, "no mesh"},
        {"no asset", [](GltfText& f) { f.json.erase("asset"); }, "asset"},
        {"attributes of different lengths",
         [](GltfText& f) {
             f.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = f.normals({0, 0, 1});
         },
         "NORMAL"},
        {"a texture that is no image",
         [](GltfText& f) {
             f.json["images"] = {{{"uri", "data:image/png;base64,AAAAAAAAAAAAAAAA"}}};
             f.json["textures"] = {{{"source", 0}}};
             f.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
             f.json["meshes"][0]["primitives"][0]["material"] = 0;
         },
         ""},
    };
    for (const Case& c : cases) {
        GltfText file = good_file();
        c.spoil(file);
        TemporaryFolder folder;
        file.write(folder / "scene.gltf");
        std::string what;
        try {
            flatten(GltfDocument::read(folder / "scene.gltf"));
        } catch (const InputError& error) {
            what = error.what();
        }
        EXPECT_FALSE(what.empty()) << c.what << " was read";
        EXPECT_NE(what.find(c.says), std::string::npos) << c.what << ": " << what;
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        EXPECT_NE(what.find("scene.gltf"), std::string::npos) << what;
    }
}

TEST(GltfErrors, DeepNestingIsRefused) {
    TemporaryFolder folder;
    std::string text = R"({"asset":{"version":"2.0"},"extras":)";
    text += std::string(200000, '[') + std::string(200000, ']') + "}";
    std::ofstream(folder / "deep.gltf") << text;
    EXPECT_THROW(GltfDocument::read(folder / "deep.gltf"), InputError);
}

/// A root, and nodes below one another, the mesh in the last.
GltfText chain(int depth) {
    GltfText file = good_file();
    file.json["nodes"] = nlohmann::json::array();
    for (int i = 1; i < depth; ++i)
        file.json["nodes"].push_back({{"children", {i}}});
    file.json["nodes"].push_back({{"mesh", 0}});
    return file;
}

TEST(GltfErrors, NodesHaveAMostDepth) {
    EXPECT_EQ(file_complaint(chain(1000)), "");
    EXPECT_NE(file_complaint(chain(1001)).find("nested deeper than the limit of 1000"), std::string::npos);
}

TEST(GltfErrors, NamesAreShownOnOneLineOfSomeLength) {
    GltfText file = good_file();
    file.json["meshes"][0]["name"] = "\x1b[31mred\n" + std::string(5000, 'x');
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = file.normals({0, 0, 1});
    const std::string what = file_complaint(file);
    EXPECT_NE(what.find("'?[31mred?xxx"), std::string::npos) << what;
    EXPECT_LT(what.size(), 400u);
}

TEST(GltfErrors, FilesThatAreNoGltf) {
    TemporaryFolder folder;
    for (const std::string& text :
         {std::string(), std::string("x"), std::string("glTF"), std::string("[]"), std::string("{}"),
          std::string("glTF\2\0\0\0\xff\xff\xff\xff\xff\xff\xff\xffJSON", 20), std::string(1000, '\0')}) {
        std::ofstream(folder / "no.glb", std::ios::binary) << text;
        EXPECT_THROW(GltfDocument::read(folder / "no.glb"), InputError) << text.size();
    }
    const std::vector<std::pair<std::string, std::string>> broken = {
        {"{", "its JSON is cut off"},
        {"", "its JSON is empty"},
        {"{\n  \"asset\": }", "its JSON is broken at line 2, column 12"},
        {"{\"a\": 1e999}", "its JSON holds a number out of range"}};
    for (const auto& [text, says] : broken) {
        std::ofstream(folder / "broken.gltf") << text;
        try {
            GltfDocument::read(folder / "broken.gltf");
            FAIL() << text;
        } catch (const InputError& error) {
            EXPECT_EQ(std::string(error.what()), (folder / "broken.gltf").string() + ": is not a glTF file: " + says);
        }
    }
    EXPECT_THROW(GltfDocument::read(folder / "missing.glb"), InputError);
    EXPECT_THROW(GltfDocument::read(folder.path()), InputError);
}

} // namespace
} // namespace kokage

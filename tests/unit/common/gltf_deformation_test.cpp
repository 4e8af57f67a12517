// Morph targets, skins, instances and levels of detail: what a glTF shows is not always what its arrays hold.
#include "common/services/error.h"
#include "tests/unit/common/gltf_loading.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using test::expect_near, test::load;

TEST(GltfDeformation, MorphTargetsAreAddedByTheirWeights) {
    GltfText file = GltfText::triangle();
    auto& primitive = file.json["meshes"][0]["primitives"][0];
    const int up = file.positions({0, 1, 0, 0, 1, 0, 0, 1, 0}), aside = file.positions({0, 0, 0, 4, 0, 0, 0, 0, 0});
    primitive["targets"] = {{{"POSITION", up}}, {{"POSITION", aside}}};
    file.node({{"mesh", 0}});
    file.scene({0});
    expect_near(load(file).meshes[0].positions[1], {1, 0, 0});
    file.json["meshes"][0]["weights"] = {0.5, 0.25};
    expect_near(load(file).meshes[0].positions[0], {0, 0.5f, 0});
    expect_near(load(file).meshes[0].positions[1], {2, 0.5f, 0});
    file.json["nodes"][0]["weights"] = {2.0, 0.0}; // a node's own come first
    expect_near(load(file).meshes[0].positions[1], {1, 2, 0});
}

/// Two joints: the first stays, the second is raised by 3 and turned by 90 degrees about z.
GltfText skinned() {
    GltfText file = GltfText::triangle();
    auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["JOINTS_0"] =
        file.accessor(std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4", 4, 5121);
    attributes["WEIGHTS_0"] =
        file.accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0}, "VEC4", 4, 5126);
    file.node(
        {{"mesh", 0}, {"skin", 0}, {"translation", {100, 0, 0}}}); // a skinned mesh's own transform does not count
    file.node({{"name", "root"}});
    file.node({{"translation", {0, 3, 0}}, {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}});
    file.scene({0, 1, 2});
    // Inverse bind matrices: the second joint stood at (1, 0, 0).
    const int inverse = file.accessor(std::vector<float>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0,  0, 0, 1, //
                                                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
                                      "MAT4", 16, 5126);
    file.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", inverse}}};
    return file;
}

TEST(GltfDeformation, SkinsFollowTheirJoints) {
    const MeshScene scene = load(skinned());
    const auto& positions = scene.meshes[0].positions;
    expect_near(positions[0], {0, 0, 0});
    expect_near(positions[1], {0, 3, 0}); // (1,0,0) - (1,0,0), turned, raised
    // (0,1,0): half in place, half at (-1,1,0) turned to (-1,-1,0), raised to (-1,2,0).
    expect_near(positions[2], {-0.5f, 1.5f, 0});
    GltfText broken = skinned();
    broken.json["skins"][0]["joints"] = {1};
    EXPECT_THROW(load(broken), InputError);
    broken = skinned();
    broken.json["nodes"][0]["skin"] = 7;
    EXPECT_THROW(load(broken), InputError);
}

TEST(GltfDeformation, InstancesMirrorAndScaleOneByOne) {
    GltfText file = GltfText::triangle();
    nlohmann::json attributes;
    attributes["TRANSLATION"] = file.positions({0, 0, 0, 5, 0, 0});
    attributes["SCALE"] = file.positions({1, 1, 1, -2, 1, 1});
    file.node({{"mesh", 0},
               {"translation", {0, 10, 0}},
               {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
    file.scene({0});
    const MeshScene scene = load(file);
    ASSERT_EQ(scene.meshes.size(), 1u);
    const SceneMesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 6u);
    ASSERT_EQ(mesh.triangles.size(), 2u);
    expect_near(mesh.positions[1], {1, 10, 0});
    expect_near(mesh.positions[4], {3, 10, 0});
    for (const glm::uvec3& t :
         mesh.triangles) // mirrored instances turn their winding, so that the front stays in front
        EXPECT_GT(glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).z,
                  0);
    GltfText uneven = file;
    uneven.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
        uneven.positions({1, 1, 1});
    EXPECT_THROW(load(uneven), InputError);
}

TEST(GltfDeformation, InstancesBeyondTheLimitAreRefusedBeforeTheyTakeMemory) {
    // 300,000 instances of a mesh of 3,000 vertices: 900 million.
    GltfText file;
    file.mesh({{"attributes", {{"POSITION", file.positions(std::vector<float>(9000, 0.5f))}}}});
    nlohmann::json attributes;
    attributes["TRANSLATION"] = file.positions(std::vector<float>(900000, 1.f));
    file.node({{"mesh", 0}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}});
    file.scene({0});
    try {
        load(file);
        FAIL() << "900 million vertices were read";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("limit"), std::string::npos) << error.what();
    }
}

TEST(GltfDeformation, OfLevelsOfDetailTheFinestIsRead) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}, {"name", "Oak_LOD1"}, {"translation", {1, 0, 0}}});
    file.node({{"mesh", 0}, {"name", "Oak_LOD0"}, {"translation", {2, 0, 0}}});
    file.node({{"name", "Oak_LOD2"}, {"children", {3}}});
    file.node({{"mesh", 0}, {"name", "billboard"}});
    file.node({{"mesh", 0}, {"name", "Elm_LOD3"}, {"translation", {5, 0, 0}}}); // the only one of its name
    file.scene({0, 1, 2, 4});
    const MeshScene scene = load(file);
    ASSERT_EQ(scene.meshes.size(), 2u);
    expect_near(scene.meshes[0].positions[0], {2, 0, 0});
    expect_near(scene.meshes[1].positions[0], {5, 0, 0});
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("2 coarser levels"), std::string::npos) << scene.notes[0];
}

TEST(GltfDeformation, ScenesThatListNothingAreReadWhole) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}});
    file.json["scenes"] = {{{"name", "empty"}}};
    const MeshScene scene = load(file);
    EXPECT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.notes.size(), 1u);
}

} // namespace
} // namespace kokage

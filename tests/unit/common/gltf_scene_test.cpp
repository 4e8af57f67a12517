// Flattening: nodes, scenes, winding, normals, texture coordinates, accessors of every kind.
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "tests/support/program_run.h"
#include "tests/unit/common/gltf_loading.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

using test::expect_near, test::load;

glm::vec3 geometric_normal(const SceneMesh& mesh, std::size_t t) {
    const glm::uvec3 c = mesh.triangles[t];
    return glm::normalize(
        glm::cross(mesh.positions[c.y] - mesh.positions[c.x], mesh.positions[c.z] - mesh.positions[c.x]));
}

TEST(GltfScene, MultipliesNodeTransforms) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}, {"translation", {1, 0, 0}}});
    file.node({{"children", {0}},
               {"scale", {2, 2, 2}},
               {"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}}); // 90 degrees about z
    file.scene({1});
    const MeshScene scene = load(file);
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_near(scene.meshes[0].positions[0], {0, 2, 0}); // (1,0,0) turned to (0,1,0), doubled
    expect_near(scene.meshes[0].positions[1], {0, 4, 0});
    expect_near(scene.meshes[0].positions[2], {-2, 2, 0});
    expect_near(scene.meshes[0].normals[0], {0, 0, 1});
}

TEST(GltfScene, MirroringNodesKeepTheFrontOutside) {
    GltfText file = GltfText::triangle();
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = file.normals({0, 0, 1, 0, 0, 1, 0, 0, 1});
    file.node({{"mesh", 0}, {"scale", {-1, 1, 1}}});
    file.scene({0});
    const MeshScene scene = load(file);
    const SceneMesh& mesh = scene.meshes[0];
    // Mirrored in x, the side that faced +Z still does: by glTF's rule the winding turns with the determinant's sign.
    expect_near(geometric_normal(mesh, 0), {0, 0, 1});
    expect_near(mesh.normals[0], {0, 0, 1});
}

TEST(GltfScene, NormalsStayPerpendicularUnderUnevenScale) {
    GltfText file;
    const float r = std::sqrt(0.5f);
    const int position = file.positions({0, 0, 0, 0, 0, 1, 1, -1, 0}); // a plane that falls at 45 degrees along x
    const int normal = file.normals({r, r, 0, r, r, 0, r, r, 0});
    file.mesh({{"attributes", {{"POSITION", position}, {"NORMAL", normal}}}});
    for (const double sign : {1.0, -1.0}) {
        file.json["nodes"] = nlohmann::json::array();
        file.json.erase("scenes");
        file.node({{"mesh", 0}, {"scale", {3.0 * sign, 1.0, 2.0}}});
        file.scene({0});
        const MeshScene scene = load(file);
        const SceneMesh& mesh = scene.meshes[0];
        expect_near(mesh.normals[0], geometric_normal(mesh, 0), 1e-5f);
        EXPECT_GT(mesh.normals[0].y, 0.f);
    }
}

TEST(GltfScene, MissingNormalsComeFromTheTriangles) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}, {"scale", {1, 1, -1}}});
    file.scene({0});
    const MeshScene scene = load(file);
    expect_near(scene.meshes[0].normals[2], geometric_normal(scene.meshes[0], 0));
}

TEST(GltfScene, AMeshThatTwoNodesShareComesTwice) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}, {"translation", {5, 0, 0}}});
    file.node({{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 7, 0, 1}}});
    file.scene({0, 1});
    const MeshScene scene = load(file);
    ASSERT_EQ(scene.meshes.size(), 2u);
    expect_near(scene.meshes[0].positions[0], {5, 0, 0});
    expect_near(scene.meshes[1].positions[0], {0, 7, 0});
}

TEST(GltfScene, ListedChildrenAreDrawnOnceAndInPlace) {
    GltfText file = GltfText::triangle();
    file.node({{"children", {1}}, {"translation", {0, 3, 0}}});
    file.node({{"mesh", 0}});
    for (const std::vector<int>& listed : {std::vector<int>{1}, {0, 1}, {1, 0}, {1, 1}, {0}}) {
        file.json.erase("scenes");
        file.scene(listed);
        const MeshScene scene = load(file);
        ASSERT_EQ(scene.meshes.size(), 1u) << listed.size() << " listed, first " << listed[0];
        expect_near(scene.meshes[0].positions[0], {0, 3, 0});
    }
}

TEST(GltfScene, ReadsTheDefaultSceneAndNotesTheOthers) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}});
    file.node({{"mesh", 0}, {"translation", {0, 0, 9}}});
    file.scene({0});
    file.scene({1});
    file.json["scene"] = 1;
    const MeshScene scene = load(file);
    ASSERT_EQ(scene.meshes.size(), 1u);
    expect_near(scene.meshes[0].positions[0], {0, 0, 9});
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("scene 0"), std::string::npos);
    file.json.erase("scene");
    file.json.erase("scenes");
    EXPECT_EQ(load(file).meshes.size(), 2u) << "without scenes, every root is read";
}

TEST(GltfScene, FarFromTheOriginPositionsStayExact) {
    GltfText file = GltfText::triangle();
    file.node({{"mesh", 0}, {"translation", {1e7, 2e7, -1e7}}, {"scale", {0.001, 0.001, 0.001}}});
    file.scene({0});
    const MeshScene scene = load(file);
    const SceneMesh& mesh = scene.meshes[0];
    EXPECT_NEAR(mesh.positions[1].x - mesh.positions[0].x, 0.001f, 1e-9f);
    EXPECT_NEAR(scene.origin.x + double(mesh.positions[0].x), 1e7, 1e-8);
    EXPECT_NEAR(scene.origin.y + double(mesh.positions[2].y), 2e7 + 0.001, 1e-8);
    expect_near(geometric_normal(mesh, 0), {0, 0, 1});
}

TEST(GltfScene, StripsAndFansAreTriangles) {
    GltfText file;
    const int position = file.positions({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    file.mesh({{"attributes", {{"POSITION", position}}}, {"mode", 5}});
    file.mesh({{"attributes", {{"POSITION", position}}}, {"mode", 6}, {"indices", file.indices({0, 1, 3, 2})}});
    file.mesh({{"attributes", {{"POSITION", position}}}, {"mode", 1}});
    for (int i = 0; i < 3; ++i)
        file.node({{"mesh", i}});
    file.scene({0, 1, 2});
    const MeshScene scene = load(file);
    ASSERT_EQ(scene.meshes.size(), 2u) << "lines are left out";
    ASSERT_EQ(scene.notes.size(), 1u);
    for (const SceneMesh& mesh : scene.meshes) {
        ASSERT_EQ(mesh.triangles.size(), 2u);
        for (std::size_t t = 0; t < 2; ++t)
            expect_near(geometric_normal(mesh, t), {0, 0, 1});
    }
}

TEST(GltfScene, ReadsNormalisedIntegersStridesAndSparseValues) {
    GltfText file;
    // Positions as bytes with a stride of 4, normalised: -1, 0 and 1.
    const int view = file.view(std::vector<std::int8_t>{-127, 0, 0, 99, 127, 0, 0, 99, 0, 127, -128, 99});
    file.json["bufferViews"][std::size_t(view)]["byteStride"] = 4;
    file.json["accessors"].push_back(
        {{"bufferView", view}, {"componentType", 5120}, {"normalized", true}, {"count", 3}, {"type", "VEC3"}});
    file.mesh({{"attributes", {{"POSITION", 0}}}});
    const int index_view = file.view(std::vector<std::uint8_t>{2});
    const int value_view = file.view(std::vector<float>{5, 6, 7});
    file.json["accessors"].push_back({{"componentType", 5126},
                                      {"count", 3},
                                      {"type", "VEC3"},
                                      {"sparse",
                                       {{"count", 1},
                                        {"indices", {{"bufferView", index_view}, {"componentType", 5121}}},
                                        {"values", {{"bufferView", value_view}}}}}});
    file.mesh({{"attributes", {{"POSITION", 1}}}});
    file.node({{"mesh", 0}});
    file.node({{"mesh", 1}});
    file.scene({0, 1});
    const MeshScene scene = load(file);
    EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(-1, 0, 0));
    EXPECT_EQ(scene.meshes[0].positions[2], glm::vec3(0, 1, -1));
    EXPECT_EQ(scene.meshes[1].positions[0], glm::vec3(0));
    EXPECT_EQ(scene.meshes[1].positions[2], glm::vec3(5, 6, 7));
}

/// A 2 x 1 texture: opaque sRGB 188 grey (linear 0.5029), and a transparent pixel.
std::vector<std::byte> small_png() {
    Image image(2, 1, 4);
    image.pixels = {0.5f, 0.5f, 0.5f, 1.f, 0.f, 1.f, 0.f, 0.25f};
    return encode_png(image);
}

GltfText textured(const nlohmann::json& image) {
    GltfText file = GltfText::triangle();
    auto& primitive = file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = file.uvs({0, 0, 1, 0, 0, 1});
    primitive["attributes"]["TEXCOORD_1"] = file.uvs({0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f});
    primitive["material"] = 0;
    file.json["images"] = {image};
    file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
    file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
    file.json["materials"] = {
        {{"name", "leaf"},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.3},
         {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"baseColorFactor", {1, 0.5, 0.25, 1}}}}}};
    file.node({{"mesh", 0}});
    file.scene({0});
    return file;
}

void expect_small_texture(const MeshScene& scene) {
    const SceneMaterial& material = scene.materials[std::size_t(scene.meshes[0].material)];
    ASSERT_TRUE(material.base_color_texture.has_value());
    const SceneTexture& texture = *material.base_color_texture;
    ASSERT_TRUE(texture.alpha);
    EXPECT_EQ(texture.color->width, 2);
    EXPECT_NEAR(texture.color->at(0, 0)[0], 0.5029f, 1e-3f);
    EXPECT_EQ(texture.alpha->at(0, 0)[0], 1.f);
    EXPECT_NEAR(texture.alpha->at(1, 0)[0], 0.25f, 1e-3f);
    EXPECT_NEAR(texture.color->at(1, 0)[1], 1.f, 1e-6f)
        << "colour under transparent texels is straight, not premultiplied";
    EXPECT_EQ(texture.wrap_u, TextureWrap::clamp);
    EXPECT_EQ(texture.wrap_v, TextureWrap::mirror);
    EXPECT_EQ(material.alpha_mode, AlphaMode::mask);
    EXPECT_FLOAT_EQ(material.alpha_cutoff, 0.3f);
    EXPECT_FLOAT_EQ(material.base_color.g, 0.5f);
}

TEST(GltfScene, ReadsTexturesFromDataUrisBuffersAndFiles) {
    const std::vector<std::byte> png = small_png();
    const std::vector<unsigned char> bytes(reinterpret_cast<const unsigned char*>(png.data()),
                                           reinterpret_cast<const unsigned char*>(png.data()) + png.size());
    expect_small_texture(load(textured({{"uri", "data:image/png;base64," + base64(bytes)}})));

    GltfText in_buffer = textured({{"mimeType", "image/png"}});
    in_buffer.json["images"][0]["bufferView"] = in_buffer.view(bytes);
    expect_small_texture(load(in_buffer));

    TemporaryFolder folder;
    std::ofstream(folder / "two words.png", std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    textured({{"uri", "two%20words.png"}}).write(folder / "scene.gltf");
    expect_small_texture(flatten(GltfDocument::read(folder / "scene.gltf")));

    textured({{"uri", "missing.png"}}).write(folder / "scene.gltf");
    try {
        flatten(GltfDocument::read(folder / "scene.gltf"));
        FAIL() << "a missing texture was passed over";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("missing.png"), std::string::npos) << error.what();
    }
}

TEST(GltfScene, ReadsNormalTexturesOfOpaqueMaterialsWhenAsked) {
    const std::vector<std::byte> png = small_png();
    const std::vector<unsigned char> bytes(reinterpret_cast<const unsigned char*>(png.data()),
                                           reinterpret_cast<const unsigned char*>(png.data()) + png.size());
    GltfText file = textured({{"uri", "data:image/png;base64," + base64(bytes)}});
    file.json["materials"][0]["normalTexture"] = {{"index", 0}, {"scale", 0.5}};
    TemporaryFolder folder;
    for (const std::string mode : {"OPAQUE", "MASK"}) {
        file.json["materials"][0]["alphaMode"] = mode;
        file.write(folder / "scene.gltf");
        const GltfDocument document = GltfDocument::read(folder / "scene.gltf");
        MeshScene scene = flatten(document);
        EXPECT_FALSE(scene.materials[0].normal_texture) << "nobody asked";
        read_gltf_normal_textures(document, scene);
        ASSERT_EQ(scene.materials[0].normal_texture.has_value(), mode == "OPAQUE");
    }
    file.json["materials"][0]["alphaMode"] = "OPAQUE";
    file.write(folder / "scene.gltf");
    const GltfDocument document = GltfDocument::read(folder / "scene.gltf");
    MeshScene scene = flatten(document);
    read_gltf_normal_textures(document, scene);
    EXPECT_FLOAT_EQ(scene.materials[0].normal_scale, 0.5f);
    EXPECT_NEAR(scene.materials[0].normal_texture->color->at(0, 0)[0], 188.f / 255, 3e-3f)
        << "numbers, not decoded from sRGB";
    EXPECT_TRUE(lies_alike(*scene.materials[0].normal_texture, *scene.materials[0].base_color_texture));
}

TEST(GltfScene, AppliesTextureTransforms) {
    const std::vector<std::byte> png = small_png();
    const std::vector<unsigned char> bytes(reinterpret_cast<const unsigned char*>(png.data()),
                                           reinterpret_cast<const unsigned char*>(png.data()) + png.size());
    GltfText file = textured({{"uri", "data:image/png;base64," + base64(bytes)}});
    auto& info = file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
    file.json["extensionsUsed"] = {"KHR_texture_transform"};
    file.json["extensionsRequired"] = {"KHR_texture_transform"};
    info["extensions"]["KHR_texture_transform"] = {{"offset", {0.25, 0.5}}, {"scale", {2.0, 3.0}}};
    MeshScene scene = load(file);
    EXPECT_EQ(scene.meshes[0].uvs[0], glm::vec2(0.25f, 0.5f));
    EXPECT_EQ(scene.meshes[0].uvs[1], glm::vec2(2.25f, 0.5f));
    EXPECT_EQ(scene.meshes[0].uvs[2], glm::vec2(0.25f, 3.5f));
    // Scale, then a quarter turn counter-clockwise as seen with v downwards: u goes to -v.
    info["extensions"]["KHR_texture_transform"]["rotation"] = 1.5707963267948966;
    scene = load(file);
    EXPECT_NEAR(scene.meshes[0].uvs[1].x, 0.25f, 1e-6f);
    EXPECT_NEAR(scene.meshes[0].uvs[1].y, 0.5f - 2.f, 1e-6f);
    EXPECT_NEAR(scene.meshes[0].uvs[2].x, 0.25f + 3.f, 1e-6f);
    info["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}};
    scene = load(file);
    EXPECT_EQ(scene.meshes[0].uvs[0], glm::vec2(0.5f));
}

TEST(GltfScene, ReadsMaterialExtensions) {
    GltfText file = GltfText::triangle();
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    file.json["materials"] = {
        {{"extensions",
          {{"KHR_materials_unlit", nlohmann::json::object()},
           {"KHR_materials_diffuse_transmission",
            {{"diffuseTransmissionFactor", 0.4}, {"diffuseTransmissionColorFactor", {0.1, 0.2, 0.3}}}}}}}};
    file.node({{"mesh", 0}});
    file.scene({0});
    const MeshScene scene = load(file);
    const SceneMaterial& material = scene.materials[0];
    EXPECT_TRUE(material.unlit);
    ASSERT_TRUE(material.diffuse_transmission.has_value());
    EXPECT_FLOAT_EQ(*material.diffuse_transmission, 0.4f);
    EXPECT_FLOAT_EQ(material.diffuse_transmission_color.b, 0.3f);
}

} // namespace
} // namespace kokage

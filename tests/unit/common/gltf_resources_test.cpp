// What lies beside a glTF file or packed inside of it: names, textures that can't be decoded, counts that lie.
#include "common/gltf/gltf_scene.h"

#include "common/services/error.h"
#include "common/services/named_file.h"
#include "tests/support/tree_file_kinds.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

std::string resource_complaint(const std::filesystem::path& path) {
    try {
        flatten(GltfDocument::read(path));
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

std::string resource_complaint(const GltfText& file) {
    TemporaryFolder folder;
    file.write(folder / "tree.gltf");
    return resource_complaint(folder / "tree.gltf");
}

void expect_says(const std::string& what, const std::string& words) {
    EXPECT_NE(what.find(words), std::string::npos) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
}

TEST(GltfResources, BuffersMustLieInTheirOwnFolder) {
    TemporaryFolder folder;
    const GltfText plain = tree_of(plain_primitive);
    const std::string bytes(plain.bytes.begin(), plain.bytes.end());
    std::filesystem::create_directories(folder / "scene");
    const auto put = [](const std::filesystem::path& path, const std::string& text) {
        std::ofstream(path, std::ios::binary) << text;
    };
    put(folder / "secret.bin", bytes);
    put(folder / "scene" / "100% b.bin", bytes);
    const auto with = [&](const std::string& uri) {
        put(folder / "scene" / "tree.gltf", plain.text_beside(uri));
        return resource_complaint(folder / "scene" / "tree.gltf");
    };
    EXPECT_EQ(with("100%25%20b.bin"), "");
    EXPECT_EQ(with("100% b.bin"), "") << "names that were not escaped";
    EXPECT_EQ(with("./100% b.bin"), "");
    EXPECT_EQ(with("parts/../100% b.bin").find("is not there") == std::string::npos, false);
    expect_says(with("../secret.bin"), "lies outside of its folder");
    expect_says(with("%2e%2e/secret.bin"), "lies outside of its folder");
    expect_says(with("..\\secret.bin"), "outside of its folder");
    expect_says(with((folder / "secret.bin").string()), "relative to its own folder");
    expect_says(with("https://example.com/a.bin"), "relative to its own folder");
    expect_says(with("file:///etc/passwd"), "relative to its own folder");
    expect_says(with("C:\\tree.bin"), "relative to its own folder");
    expect_says(with("missing\nname.bin"), "is not there: put it beside the file");
    expect_says(with("missing%20name.bin"), "'missing name.bin', which is not there");
    put(folder / "scene" / "short.bin", bytes.substr(0, 100));
    expect_says(with("short.bin"), "is cut off");
}

TEST(GltfResources, ImagesMayLieInANeighbouringFolder) {
    TemporaryFolder folder;
    std::filesystem::create_directories(folder / "scene");
    std::filesystem::create_directories(folder / "textures");
    const std::vector<unsigned char> png = leaf_png();
    std::ofstream(folder / "textures" / "leaf.png", std::ios::binary) << std::string(png.begin(), png.end());
    GltfText file = tree_of(plain_primitive);
    file.json["images"] = {{{"uri", "../textures/leaf.png"}}};
    file.write(folder / "scene" / "tree.gltf");
    EXPECT_EQ(resource_complaint(folder / "scene" / "tree.gltf"), "");
    file.json["images"] = {{{"uri", "..\\textures\\leaf.png"}}};
    file.write(folder / "scene" / "tree.gltf");
    EXPECT_EQ(resource_complaint(folder / "scene" / "tree.gltf"), "");
}

/// A KTX2 file's first bytes.
std::vector<unsigned char> ktx2() {
    std::vector<unsigned char> bytes{0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n'};
    bytes.resize(80);
    return bytes;
}

TEST(GltfResources, ColoursInBasisUAreReplacedAndMasksRefused) {
    GltfText file = tree_of(plain_primitive);
    file.json["images"].push_back({{"mimeType", "image/ktx2"}});
    file.json["images"][1]["bufferView"] = file.view(ktx2());
    file.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 1}}}}}}};
    require(file, "KHR_texture_basisu");
    const std::string refused = resource_complaint(file);
    expect_says(refused, "material 1 'leaf': its alpha mask is in KTX2 (BasisU), which can't be decoded");
    expect_says(refused, "export its textures as PNG, JPEG or WebP");

    file.json["materials"][1].erase("alphaMode");
    TemporaryFolder folder;
    file.write(folder / "tree.gltf");
    const MeshScene scene = flatten(GltfDocument::read(folder / "tree.gltf"));
    EXPECT_TRUE(scene.materials[1].color_is_lost);
    EXPECT_FALSE(scene.materials[0].color_is_lost);
    ASSERT_EQ(scene.notes.size(), 1u);
    expect_says(scene.notes[0], "its colour texture is in KTX2 (BasisU), which can't be decoded: a plain colour");

    file.json["materials"][1]["alphaMode"] = "MASK"; // a fallback that can be read is taken
    file.json["textures"][0]["source"] = 0;
    EXPECT_EQ(resource_complaint(file), "");
}

TEST(GltfResources, ExtensionsThatAreNoObjectsAreAsIfTheyWereNot) {
    for (const nlohmann::json& value : {nlohmann::json("text"), nlohmann::json(7), nlohmann::json::array({1})}) {
        GltfText file = tree_of(plain_primitive);
        nlohmann::json& leaf = file.json["materials"][1];
        for (const char* name :
             {"KHR_materials_diffuse_transmission", "KHR_materials_transmission", "KHR_materials_unlit"})
            leaf["extensions"][name] = value;
        leaf["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]["KHR_texture_transform"] = value;
        file.json["textures"][0]["extensions"]["EXT_texture_webp"] = value;
        EXPECT_EQ(resource_complaint(file), "") << value;
        leaf["extensions"]["KHR_materials_pbrSpecularGlossiness"] = value;
        EXPECT_EQ(resource_complaint(file), "") << value;
        file.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"] = value;
        EXPECT_EQ(resource_complaint(file), "") << value;
        file.json["nodes"][1]["extensions"]["EXT_mesh_gpu_instancing"] = {{"attributes", value}};
        expect_says(resource_complaint(file), "none of TRANSLATION");
    }
}

TEST(GltfResources, NormalMapsThatAreMissingDoNoHarm) {
    GltfText file = tree_of(plain_primitive);
    file.json["images"].push_back({{"uri", "missing_normal.png"}});
    file.json["textures"].push_back({{"source", 1}});
    file.json["materials"][1]["normalTexture"] = {{"index", 1}};
    EXPECT_EQ(resource_complaint(file), "");
}

TEST(GltfResources, CountsThatLieAreRefusedBeforeMemoryIsTaken) {
    // meshopt: more elements than its bytes can hold.
    GltfText meshopt =
        tree_of([](GltfText& f, const PlainMesh& m, int material) { return meshopt_primitive(f, m, material, false); });
    for (nlohmann::json& view : meshopt.json["bufferViews"])
        if (view.contains("extensions")) {
            nlohmann::json& extension = view["extensions"]["EXT_meshopt_compression"];
            const nlohmann::json original = extension;
            for (const std::uint64_t count :
                 {std::uint64_t(3) << 20, std::uint64_t(3) << 40, ~std::uint64_t(0) / 3 * 3}) {
                extension["count"] = count;
                expect_says(resource_complaint(meshopt), "can hold");
            }
            extension = original;
            extension["byteStride"] = 4096;
            expect_says(resource_complaint(meshopt), "stride of 4096");
            extension = original;
            extension["mode"] = "TETRAHEDRA";
            expect_says(resource_complaint(meshopt), "TETRAHEDRA");
            extension = original;
            extension["filter"] = "COLOR";
            expect_says(resource_complaint(meshopt), "filter 'COLOR'");
            extension = original;
        }
    EXPECT_EQ(resource_complaint(meshopt), "");

    // Draco, by edges: vertices and faces follow the header of 11 bytes and the method's byte, 7 bits in each byte.
    GltfText draco =
        tree_of([](GltfText& f, const PlainMesh& m, int material) { return draco_primitive(f, m, material, false); });
    ASSERT_EQ(resource_complaint(draco), "");
    const nlohmann::json& primitive = draco.json["meshes"][1]["primitives"][0];
    const auto view = primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"].get<std::size_t>();
    const auto offset = draco.json["bufferViews"][view]["byteOffset"].get<std::size_t>();
    ASSERT_EQ(
        std::string(draco.bytes.begin() + std::ptrdiff_t(offset), draco.bytes.begin() + std::ptrdiff_t(offset) + 5),
        "DRACO");
    for (const std::size_t at : {12u, 17u})
        for (std::size_t i = 0; i < 5; ++i)
            draco.bytes[offset + at + i] = i < 4 ? 0xff : 0x04;
    expect_says(resource_complaint(draco), "faces and 1342177279 vertices, more than its");
    draco.bytes[offset + 6] = 1;
    expect_says(resource_complaint(draco), "is of version 2.1");
}

TEST(NamedFile, DecodesEscapes) {
    EXPECT_EQ(percent_decoded("a%20b%C3%a4"), "a b\xc3\xa4");
    EXPECT_EQ(percent_decoded("100%"), "100%");
    EXPECT_EQ(percent_decoded("%zz%0"), "%zz%0");
    EXPECT_EQ(percent_decoded("a%00b"), "a%00b") << "a zero would cut the name short";
}

} // namespace
} // namespace kokage

#include "common/obj/obj_scene.h"

#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "tests/support/tree_file_kinds.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

MeshScene load(const std::string& obj, const std::map<std::string, std::string>& files = {}) {
    TemporaryFolder folder;
    FileKind kind{"obj", "tree.obj", files};
    kind.files["tree.obj"] = obj;
    write_files(kind, folder.path());
    return read_obj_scene(folder / "tree.obj");
}

std::string obj_complaint(const std::string& obj, const std::map<std::string, std::string>& files = {}) {
    try {
        load(obj, files);
    } catch (const InputError& error) {
        const std::string what = error.what();
        EXPECT_EQ(what.find('\n'), std::string::npos) << what;
        EXPECT_NE(what.find("tree.obj"), std::string::npos) << what;
        return what;
    }
    return "";
}

std::string leaf_file() {
    const std::vector<unsigned char> png = leaf_png();
    return {png.begin(), png.end()};
}

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";

TEST(ObjScene, PolygonsOfAnyShapeAreCovered) {
    // An L of six corners, and its mirror image given from the end, on a line that goes on after a backslash.
    const MeshScene scene = load("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                                 "f 1 2 3 4 5 6\nf -1 -2 -3 \\\n-4 -5 -6\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    const SceneMesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.triangles.size(), 8u);
    float front = 0, back = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        const float area =
            0.5f * glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]).z;
        (area > 0 ? front : back) += area;
    }
    EXPECT_FLOAT_EQ(front, 3);
    EXPECT_FLOAT_EQ(back, -3);
}

TEST(ObjScene, VerticesMayHaveColors) {
    const auto colors = [](const std::string& vertices) { return load(vertices + "f 1 2 3\n").meshes[0].colors; };
    EXPECT_TRUE(colors("v 0 0 0\nv 1 0 0 1\nv 1 1 0\n").empty()) << "w is no colour";
    const std::vector<glm::vec4> some = colors("v 0 0 0 1 0.5 0\nv 1 0 0\n\tv  1 1 \\\n0 1.0 0 0 1\r\n");
    ASSERT_EQ(some.size(), 3u);
    EXPECT_EQ(some[0], glm::vec4(1, linear_from_srgb(0.5f), 0, 1));
    EXPECT_EQ(some[1], glm::vec4(1)) << "white where none is given";
    EXPECT_EQ(some[2], glm::vec4(0, 0, 1, 1)) << "behind w";
    const std::vector<glm::vec4> bytes = colors("v 0 0 0 255 127.5 0\nv 1 0 0 nan 0 0\nv 1 1 0 -3 x 1\n");
    EXPECT_EQ(bytes[0], glm::vec4(1, linear_from_srgb(0.5f), 0, 1));
    EXPECT_EQ(bytes[1], glm::vec4(1));
    EXPECT_EQ(bytes[2], glm::vec4(1));
    const MeshScene lit = load("mtllib tree.mtl\nv 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nusemtl leaf\nf 1 2 3\n",
                               {{"tree.mtl", "newmtl leaf\nKd 0.5 0.5 0.5\n"}});
    EXPECT_NEAR(lit.materials[0].base_color.r, linear_from_srgb(0.5f), 1e-6f) << "the two are multiplied, as in glTF";
    EXPECT_EQ(lit.meshes[0].colors[0], glm::vec4(1, 0, 0, 1));
    // What no file describes is as its vertices are.
    const std::string red = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\n";
    for (const std::string use : {"", "usemtl leaf\n"}) {
        const MeshScene alone = load(red + use + "f 1 2 3\n");
        EXPECT_FALSE(alone.materials[0].color_is_lost) << use;
        EXPECT_EQ(alone.materials[0].base_color, glm::vec4(1)) << use;
    }
    EXPECT_TRUE(load("v 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl leaf\nf 1 2 3\n").materials[0].color_is_lost);
}

TEST(ObjScene, ColorsAreLinearWhereBlenderWroteThem) {
    const std::string faces = "mtllib tree.mtl\n" + kSquare + "usemtl leaf\nf 1 2 3 4\n",
                      mtl = "newmtl leaf\nKd 0.1 0.3 0.05\n";
    const auto color = [](const MeshScene& scene) { return scene.materials[0].base_color; };
    const MeshScene plain = load(faces, {{"tree.mtl", mtl}});
    EXPECT_FLOAT_EQ(color(plain).g, linear_from_srgb(0.3f));
    ASSERT_EQ(plain.notes.size(), 1u);
    EXPECT_NE(plain.notes[0].find("read as sRGB"), std::string::npos) << plain.notes[0];
    const MeshScene by_mtl = load(faces, {{"tree.mtl", "# Blender 4.2.0 MTL File: 'None'\n" + mtl}});
    EXPECT_EQ(color(by_mtl), glm::vec4(0.1f, 0.3f, 0.05f, 1));
    ASSERT_EQ(by_mtl.notes.size(), 1u);
    EXPECT_NE(by_mtl.notes[0].find("read as linear"), std::string::npos) << by_mtl.notes[0];
    EXPECT_EQ(color(load("# a tree\n# Blender v2.79 OBJ File\n" + faces, {{"tree.mtl", mtl}})), color(by_mtl));
    EXPECT_TRUE(load(faces, {{"tree.mtl", "newmtl leaf\nKd 0 1 0\n"}}).notes.empty()) << "the same either way";
}

TEST(ObjScene, CornersShareVerticesAndMissingNormalsAreComputed) {
    const MeshScene scene = load(kSquare + "f 1/1 2/2 3/3\nf 1/1 3/3 4/4\n");
    const SceneMesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1));
    EXPECT_EQ(mesh.uvs[2], glm::vec2(1, 0)) << "v points down";
    // Without texture coordinates, and with normals for some corners alone.
    const MeshScene bare = load(kSquare + "vn 0 0 -2\nf 1//1 2 3\n");
    EXPECT_TRUE(bare.meshes[0].uvs.empty());
    EXPECT_EQ(bare.meshes[0].normals[0], glm::vec3(0, 0, -1));
    EXPECT_EQ(bare.meshes[0].normals[1], glm::vec3(0, 0, 1));
}

TEST(ObjScene, GroupsAndMaterialsMakeMeshes) {
    const MeshScene scene = load("mtllib tree.mtl\n" + kSquare +
                                     "g trunk rest\nusemtl wood\nf 1 2 3\ng crown\nusemtl leaf\nf 1 2 3\nf 1 3 4\n"
                                     "usemtl wood\nf 2 3 4\ng trunk\nf 1 2 4\n",
                                 {{"tree.mtl", "newmtl wood\nKd 0.5 0.25 1\nnewmtl leaf\nKd 0 1 0\nd 0.5\n"}});
    ASSERT_EQ(scene.meshes.size(), 3u);
    EXPECT_EQ(scene.meshes[0].name, "trunk");
    EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
    EXPECT_EQ(scene.meshes[1].name, "crown");
    EXPECT_EQ(scene.meshes[1].triangles.size(), 2u);
    const SceneMaterial& wood = scene.materials[std::size_t(scene.meshes[0].material)];
    EXPECT_EQ(wood.name, "wood");
    EXPECT_NEAR(wood.base_color.r, linear_from_srgb(0.5f), 1e-6f);
    EXPECT_EQ(wood.alpha_mode, AlphaMode::opaque);
    EXPECT_TRUE(wood.double_sided);
    const SceneMaterial& leaf = scene.materials[std::size_t(scene.meshes[1].material)];
    EXPECT_EQ(leaf.alpha_mode, AlphaMode::blend);
    EXPECT_FLOAT_EQ(leaf.base_color.a, 0.5f);
}

TEST(ObjScene, MasksComeFromMapDOrFromTheColoursAlpha) {
    const std::string obj = "mtllib tree.mtl\n" + kSquare + "usemtl leaf\nf 1/1 2/2 3/3 4/4\n";
    Image small(8, 8, 1);
    small.at(0, 0)[0] = 1;
    const std::vector<std::byte> png = encode_png(small, {PngEncoding::as_is});
    const std::string mask(reinterpret_cast<const char*>(png.data()), png.size());
    const auto material = [&](const std::string& mtl) {
        return load(obj, {{"tree.mtl", mtl}, {"leaf.png", leaf_file()}, {"mask.png", mask}}).materials[0];
    };
    const SceneMaterial by_alpha = material("newmtl leaf\nmap_Kd leaf.png\n");
    EXPECT_EQ(by_alpha.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(by_alpha.base_color, glm::vec4(1)) << "no Kd";
    const SceneMaterial by_mask = material("newmtl leaf\nKd 1 1 1\nmap_Kd leaf.png\nmap_d mask.png\n");
    ASSERT_TRUE(by_mask.base_color_texture && by_mask.base_color_texture->alpha);
    const Image& alpha = *by_mask.base_color_texture->alpha;
    EXPECT_EQ(alpha.width, 16) << "as large as the colour";
    EXPECT_EQ(alpha.at(1, 1)[0], 1.f);
    EXPECT_EQ(alpha.at(2, 1)[0], 0.f);
    const SceneMaterial alone = material("newmtl leaf\nmap_d mask.png\n");
    EXPECT_EQ(alone.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(alone.base_color_texture->color->at(3, 3)[0], 1.f);
    // Another machine's path, and options.
    const MeshScene scaled =
        load(obj, {{"tree.mtl", "newmtl leaf\nmap_Kd -s 2 3 1 -o 0.5 0.25 0 C:\\trees\\my\\leaf.png\n"},
                   {"leaf.png", leaf_file()}});
    EXPECT_TRUE(scaled.materials[0].base_color_texture.has_value());
    EXPECT_EQ(scaled.meshes[0].uvs[2], glm::vec2(2.5f, 1 - 3.25f));
}

TEST(ObjScene, WhatIsMissingIsSaidOrRefused) {
    const std::string obj = "mtllib tree.mtl\n" + kSquare + "usemtl leaf\nf 1/1 2/2 3/3\n";
    const MeshScene without_library = load(obj);
    EXPECT_TRUE(without_library.materials[std::size_t(without_library.meshes[0].material)].color_is_lost);
    ASSERT_GE(without_library.notes.size(), 1u);
    EXPECT_NE(without_library.notes[0].find("material file 'tree.mtl' is not there"), std::string::npos);
    const MeshScene without_color = load(obj, {{"tree.mtl", "newmtl leaf\nmap_Kd gone.png\n"}});
    EXPECT_TRUE(without_color.materials[0].color_is_lost);
    ASSERT_EQ(without_color.notes.size(), 1u);
    EXPECT_NE(without_color.notes[0].find("'gone.png' is not there"), std::string::npos) << without_color.notes[0];
    EXPECT_NE(obj_complaint(obj, {{"tree.mtl", "newmtl leaf\nmap_d gone.png\n"}}).find("alpha mask 'gone.png'"),
              std::string::npos);
}

TEST(ObjScene, VerticesThatAreNoNumbersAreRefusedWithTheirLine) {
    for (const char* vertex :
         {"v 1e300 0 0", "v nan 0 0", "v 0 inf 0", "  v 0 0 -Inf", "v 0 zero 0", "v 0 0", "v 1 2 #"}) {
        const std::string said = obj_complaint("# a square\n" + std::string(vertex) + "\n" + kSquare + "f 1 2 3\n");
        EXPECT_NE(said.find("line 2: a vertex needs three finite numbers"), std::string::npos)
            << vertex << ": " << said;
    }
    const MeshScene scene = load("v +1 .5 2. 1\nv\t1e-3  -2 0 0.5 0.5 0.5\n v 1 \\\n2 3\nf 1 2 3\n");
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].positions.size(), 3u);
}

TEST(ObjScene, ErrorsNameTheFace) {
    EXPECT_NE(obj_complaint("").find("no faces"), std::string::npos);
    EXPECT_NE(obj_complaint(kSquare + "f 1 2\n").find("no faces"), std::string::npos);
    EXPECT_NE(obj_complaint(kSquare + "f 1 2 3\nf 1 2 5\n").find("face 2 names vertex 5 of 4"), std::string::npos);
    EXPECT_NE(obj_complaint(kSquare + "f 1 2 -5\n").find("face 1 names vertex -5 of 4"), std::string::npos);
    EXPECT_NE(obj_complaint(kSquare + "f 1/9 2 3\n").find("texture coordinate 9"), std::string::npos);
    EXPECT_NE(obj_complaint(kSquare + "f 0 2 3\n").find("without a vertex"), std::string::npos);
    EXPECT_NE(obj_complaint(std::string("v 0 0\0 0\n", 9)).find("zero byte"), std::string::npos);
    EXPECT_NE(obj_complaint("# " + std::string(100000, 'x')).find("longer than the limit"), std::string::npos);
    std::string many = kSquare + "f";
    for (int i = 0; i < 1025; ++i)
        many += " " + std::to_string(i % 4 + 1);
    EXPECT_NE(obj_complaint(many + "\n").find("1025 corners"), std::string::npos);
}

} // namespace
} // namespace kokage

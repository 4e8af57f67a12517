#include "common/geometry/crease_normals.h"
#include "common/services/error.h"
#include "common/stl/stl_scene.h"
#include "tests/support/temporary_folder.h"

#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>

namespace kokage {
namespace {

using Triangle = std::array<glm::vec3, 3>;

std::string binary_stl(const std::vector<Triangle>& triangles) {
    std::string bytes(80, ' ');
    const auto append = [&](const auto& value) {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        bytes.append(raw, sizeof value);
    };
    append(std::uint32_t(triangles.size()));
    for (const Triangle& triangle : triangles) {
        append(glm::vec3(0.f)); // a normal that says nothing
        for (const glm::vec3& corner : triangle)
            append(corner);
        append(std::uint16_t(0));
    }
    return bytes;
}

std::filesystem::path written(const TemporaryFolder& folder, const std::string& bytes) {
    const std::filesystem::path path = folder / "thing.stl";
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
}

std::vector<Triangle> cube() {
    std::vector<Triangle> triangles;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.f, 1.f}) {
            const auto corner = [&](float a, float b) {
                glm::vec3 p(0.f);
                p[std::size_t(axis)] = side;
                p[std::size_t(axis + 1) % 3] = side * a;
                p[std::size_t(axis + 2) % 3] = b;
                return p;
            };
            triangles.push_back({corner(-1, -1), corner(1, -1), corner(1, 1)});
            triangles.push_back({corner(-1, -1), corner(1, 1), corner(-1, 1)});
        }
    return triangles;
}

std::string message_of(const std::filesystem::path& path) {
    try {
        read_stl_scene(path);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(StlScene, ACubeKeepsItsEdges) {
    const TemporaryFolder folder;
    const MeshScene scene = read_stl_scene(written(folder, binary_stl(cube())));
    ASSERT_EQ(scene.meshes.size(), 1u);
    const SceneMesh& mesh = scene.meshes[0];
    EXPECT_EQ(mesh.triangles.size(), 12u);
    EXPECT_EQ(mesh.positions.size(), 24u) << "four a side";
    for (const glm::uvec3& t : mesh.triangles) {
        const glm::vec3 flat = glm::normalize(
            glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
        for (std::size_t k = 0; k < 3; ++k)
            EXPECT_LT(glm::length(mesh.normals[t[k]] - flat), 1e-6f);
        EXPECT_GT(glm::dot(flat, mesh.positions[t.x]), 0) << "outwards";
    }
    EXPECT_TRUE(scene.materials.at(0).is_missing);
}

TEST(StlScene, ReadsAsciiAndLosesNoTriangleOfAnEdgeWithThree) {
    const TemporaryFolder folder;
    std::string text = "solid fins\n";
    for (const glm::vec3& tip : {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(-1, -1, 0)})
        text += "facet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex " + std::to_string(tip.x) + " " +
                std::to_string(tip.y) + " 0\nendloop\nendfacet\n";
    const MeshScene scene = read_stl_scene(written(folder, text + "endsolid fins\n"));
    EXPECT_EQ(scene.meshes.at(0).triangles.size(), 3u);
}

TEST(StlScene, RefusesInOneLineWhatIsNoStl) {
    const TemporaryFolder folder;
    const std::string whole = binary_stl(cube());
    EXPECT_NE(message_of(written(folder, whole.substr(0, 400))).find("has 684 bytes, this file has 400"),
              std::string::npos);
    EXPECT_NE(message_of(written(folder, "")).find("empty"), std::string::npos);
    EXPECT_NE(message_of(written(folder, "solid nothing\nendsolid nothing\n")).find("no triangles"), std::string::npos);
    std::vector<Triangle> bad = cube();
    bad[3][1].y = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(message_of(written(folder, binary_stl(bad))).find("triangle 3"), std::string::npos);
    EXPECT_NE(message_of(written(folder, "solid x\nfacet\nouter loop\nvertex 0 0 one\n")).find("line 4"),
              std::string::npos);
    EXPECT_NE(message_of(folder / "none.stl").find("can't be read"), std::string::npos);
}

TEST(CreaseNormals, RoundsWhatBendsGentlyAndKeepsCreases) {
    // Two quarters of a roof: 30 degrees apart are rounded by 40, not by 20.
    const float turn = 30 * kPi / 180;
    const std::vector<glm::vec3> positions = {{0, 0, 0}, {0, 0, 1}, {-1, 0, 0}, {std::cos(turn), std::sin(turn), 0}};
    const std::vector<glm::uvec3> triangles = {{0, 2, 1}, {0, 1, 3}};
    const CreasedMesh round = crease_normals(positions, triangles, 40 * kPi / 180);
    EXPECT_EQ(round.positions.size(), 4u);
    EXPECT_EQ(round.normals[round.triangles[0].x], round.normals[round.triangles[1].x]);
    EXPECT_NEAR(glm::length(round.normals[0]), 1, 1e-6f);
    const CreasedMesh sharp = crease_normals(positions, triangles, 20 * kPi / 180);
    EXPECT_EQ(sharp.positions.size(), 6u);
    EXPECT_THROW(crease_normals(positions, {{0, 1, 4}}, 1), InputError);
    const CreasedMesh nothing = crease_normals({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{0, 1, 2}}, 1);
    for (const glm::vec3& normal : nothing.normals)
        EXPECT_EQ(normal, glm::vec3(0, 1, 0));
}

} // namespace
} // namespace kokage

// Shells under meshes, good and bad, and tangent frames.
#include "common/services/error.h"
#include "reflection/relief/relief_shell.h"
#include "reflection/relief/tangent_frames.h"
#include "tests/unit/reflection/relief_surfaces.h"

#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

using namespace test;

std::string refusal(const ReliefMesh& mesh, const ReliefDepth& depth = {}) {
    try {
        make_relief_shell(mesh, depth, "bark of oak.glb");
    } catch (const InputError& e) {
        return e.what();
    }
    return "";
}

/// Two triangles over a square of 2 x 3 m in the plane z = 0, tiles of 0.5 x 0.25 m, v downwards.
SurfaceArrays shell_square() {
    SurfaceArrays s;
    s.positions = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
    s.normals.assign(4, {0, 0, 1});
    s.uvs = {{0, 12}, {4, 12}, {4, 0}, {0, 0}};
    s.triangles = {{0, 1, 2}, {0, 2, 3}};
    return s;
}

TEST(ReliefShell, RefusesWhatItCannotUse) {
    SurfaceArrays s = shell_square();
    s.uvs.clear();
    EXPECT_EQ(refusal(s.mesh()),
              "bark of oak.glb: the mesh has no texture coordinates, and relief needs them: unwrap it, "
              "or switch its relief off");
    s = shell_square();
    s.normals.pop_back();
    EXPECT_NE(refusal(s.mesh()).find("3 normals"), std::string::npos);
    s = shell_square();
    s.uvs[2].x = std::numeric_limits<float>::quiet_NaN();
    EXPECT_NE(refusal(s.mesh()).find("vertex 2"), std::string::npos);
    s = shell_square();
    s.triangles[1].z = 4;
    EXPECT_NE(refusal(s.mesh()).find("triangle 1 has corner 4"), std::string::npos);
    EXPECT_NE(refusal(shell_square().mesh(), {-1, 0, 0.2f}).find("must be finite"), std::string::npos);
    EXPECT_NE(refusal(shell_square().mesh(), {0.1f, 0, 0.7f}).find("at most 0.5"), std::string::npos);
    EXPECT_EQ(refusal(shell_square().mesh()), "");
    EXPECT_EQ(refusal({}), "");
}

TEST(ReliefShell, PrismsOfAClosedTubeHaveNeighborsAcrossTheSeam) {
    const SurfaceArrays tube = make_tube(straight_trunk());
    const ReliefShell shell = make_relief_shell(tube.mesh(), {0.02f, 0, 0.3f}, "tube");
    EXPECT_EQ(shell.outer.size(), 24u * 13);
    std::size_t borders = 0;
    for (std::uint32_t t = 0; t < shell.prisms.size(); ++t) {
        EXPECT_FALSE(shell.prisms[t].is_solid);
        for (std::uint32_t side = 0; side < 3; ++side) {
            const std::uint32_t n = shell.prisms[t].neighbors[side];
            if (n == ReliefShell::kBorder)
                ++borders;
            else
                EXPECT_EQ(shell.prisms[n >> 2].neighbors[n & 3], t << 2 | side);
        }
    }
    EXPECT_EQ(borders, 48u);
}

TEST(ReliefShell, DepthShrinksWithTilesAndRadius) {
    const SurfaceArrays cone = make_tube(cone_branch()); // tiles 0.42 to 0.1 m around, 0.5 along
    const ReliefShell same = make_relief_shell(cone.mesh(), {0.01f, 0, 0.5f}, "cone");
    const ReliefShell narrow = make_relief_shell(cone.mesh(), {0.01f, 0.4f, 0.5f}, "cone");
    const ReliefShell round = make_relief_shell(cone.mesh(), {0.2f, 0, 0.25f}, "cone");
    const auto depth = [](const ReliefShell& shell, std::size_t i) {
        return glm::distance(shell.outer[i], shell.inner[i]);
    };
    const std::size_t foot = 0, tip = same.outer.size() - 1;
    EXPECT_NEAR(depth(same, foot), 0.01f, 1e-6f);
    EXPECT_NEAR(depth(same, tip), 0.01f, 1e-6f);
    EXPECT_NEAR(depth(narrow, foot), 0.01f, 1e-6f);
    EXPECT_NEAR(depth(narrow, tip), 0.01f * std::sqrt(2 * kPi * 0.05f / 3 * 0.5f) / 0.4f, 3e-4f);
    EXPECT_NEAR(depth(round, foot), 0.05f, 2e-3f);
    EXPECT_NEAR(depth(round, tip), 0.0125f, 1e-3f);
}

TEST(ReliefShell, DegenerateTrianglesAndNoDepthAreSolid) {
    SurfaceArrays s = shell_square();
    s.positions.push_back({1, 1.5f, 0}); // on the diagonal
    s.normals.push_back({0, 0, 1});
    s.uvs.push_back({2, 6});
    s.triangles.push_back({0, 4, 2}); // no area
    s.triangles.push_back({0, 0, 1}); // no edge
    const ReliefShell shell = make_relief_shell(s.mesh(), {0.1f, 0, 0.3f}, "square");
    EXPECT_FALSE(shell.prisms[0].is_solid);
    EXPECT_FALSE(shell.prisms[1].is_solid);
    EXPECT_TRUE(shell.prisms[2].is_solid);
    EXPECT_TRUE(shell.prisms[3].is_solid);
    for (const auto& prism : make_relief_shell(shell_square().mesh(), {0, 0, 0.3f}, "square").prisms)
        EXPECT_TRUE(prism.is_solid);
}

TEST(ReliefShell, PrismsThatWouldFoldGetShallower) {
    SurfaceArrays ridge; // normals of a sharp ridge, far deeper relief than it is wide
    ridge.positions = {{-0.1f, 0, -1}, {-0.1f, 0, 1}, {0, 0.02f, -1}, {0, 0.02f, 1}, {0.1f, 0, -1}, {0.1f, 0, 1}};
    for (const float x : {-2.f, 0.f, 2.f})
        for (int k = 0; k < 2; ++k)
            ridge.normals.push_back(glm::normalize(glm::vec3(x, 1, 0)));
    ridge.uvs = {{0, 0}, {0, 1}, {1, 0}, {1, 1}, {2, 0}, {2, 1}};
    ridge.triangles = {{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {4, 3, 5}};
    const ReliefShell shell = make_relief_shell(ridge.mesh(), {0.5f, 0, 0.5f}, "ridge");
    for (const auto& prism : shell.prisms)
        EXPECT_FALSE(prism.is_solid);
    for (std::size_t i = 0; i < shell.outer.size(); ++i)
        EXPECT_GT(glm::distance(shell.outer[i], shell.inner[i]), 0.01f);
}

TEST(TangentFrames, MeasureTilesInMetres) {
    const SurfaceArrays s = shell_square();
    const TangentFrames frames = make_tangent_frames(s.mesh());
    ASSERT_EQ(frames.corners.size(), 2u);
    const TangentFrame frame = interpolate(frames, 1, {0.2f, 0.3f, 0.5f});
    EXPECT_LT(glm::distance(frame.along_u, {0.5f, 0, 0}), 1e-6f);
    EXPECT_LT(glm::distance(frame.along_v, {0, -0.25f, 0}), 1e-6f);
    EXPECT_LT(glm::distance(frame.normal, {0, 0, 1}), 1e-6f);
    const ReliefScale scale = relief_scale(frame, 0.1f);
    EXPECT_LT(glm::distance(scale.tile_m, {0.5f, 0.25f}), 1e-6f);
    // Deeper along +u, 0.1 m a tile of 0.5 m: turned towards +u.
    EXPECT_LT(glm::distance(relief_normal(frame, {1, 0}, 0.1f), glm::normalize(glm::vec3(0.2f, 0, 1))), 1e-6f);
    EXPECT_LT(glm::distance(relief_normal(frame, {0, 1}, 0.1f), glm::normalize(glm::vec3(0, -0.4f, 1))), 1e-6f);
}

TEST(TangentFrames, AreSmoothAcrossTheSeamAndAroundTheTube) {
    const SurfaceArrays tube = make_tube(straight_trunk());
    const TangentFrames frames = make_tangent_frames(tube.mesh());
    EXPECT_EQ(frames.frames.size(), 24u * 13); // the seam's vertices, one and three tiles on, share theirs
    for (std::size_t t = 0; t < tube.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const TangentFrame& f = frames.frames[frames.corners[t][k]];
            const glm::vec3 n = tube.normals[tube.triangles[t][k]];
            // Around: the chord of a side, laid into the tangent plane at its end, keeps its length in the mean.
            EXPECT_NEAR(glm::length(f.along_u), 2 * kPi * 0.2f / 3, 0.003f);
            EXPECT_NEAR(glm::length(f.along_v), 0.5f, 1e-4f);
            EXPECT_NEAR(glm::dot(f.along_u, n), 0, 1e-5f);
            EXPECT_NEAR(glm::dot(glm::normalize(f.along_v), glm::vec3(0, -1, 0)), 1, 1e-5f);
        }
}

TEST(TangentFrames, MirroredHalvesShareNoFrame) {
    SurfaceArrays s; // a butterfly: u falls on the left of x = 0 and grows on the right
    s.positions = {{-1, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 1, 0}, {0, 1, 0}, {1, 1, 0}};
    s.normals.assign(6, {0, 0, 1});
    s.uvs = {{1, 0}, {0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 1}};
    s.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
    const TangentFrames frames = make_tangent_frames(s.mesh());
    for (std::size_t t = 0; t < 4; ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const TangentFrame& f = frames.frames[frames.corners[t][k]];
            EXPECT_LT(glm::distance(f.along_u, {t < 2 ? -1.f : 1.f, 0, 0}), 1e-6f);
            EXPECT_LT(glm::distance(f.along_v, {0, 1, 0}), 1e-6f);
        }
}

TEST(TangentFrames, TextureWithoutAreaHasNoTangents) {
    SurfaceArrays s = shell_square();
    s.uvs.assign(4, {0.5f, 0.5f});
    const TangentFrames frames = make_tangent_frames(s.mesh());
    const TangentFrame frame = interpolate(frames, 0, glm::vec3(1.f / 3));
    EXPECT_FALSE(frame.has_tangents());
    EXPECT_EQ(relief_normal(frame, {3, 4}, 0.1f), glm::vec3(0, 0, 1));
    EXPECT_EQ(relief_scale(frame, 0.1f).tile_m, glm::vec2(1));
}

} // namespace
} // namespace kokage

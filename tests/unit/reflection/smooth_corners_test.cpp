#include "reflection/smooth_corners.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <gtest/gtest.h>
#include <set>

namespace kokage::test {
namespace {

Progress quiet_corners;

/// Two faces of a box that share the edge x = 0, z from -1 to 1: one lies in the plane y = 0, x from -1 to 0, the other
/// in x = 0 below it. Every corner has a position of its own.
struct BoxEdge {
    PatchScene patches;
    ShadedScene scene;

    explicit BoxEdge(bool hard) {
        patches.optics = {{glm::vec3(0.5f), glm::vec3(0.f)}};
        add_rectangle(patches, {-1, 0, 1}, {1, 0, 0}, {0, 0, -2});
        add_rectangle(patches, {0, 0, 1}, {0, -1, 0}, {0, 0, -2});
        scene = evenly_shaded(patches, glm::vec3(1.f));
        scene.indirect_front[1] = scene.radiance_front[1] = glm::vec3(0.25f);
        for (int face = 0; face < 2; ++face)
            for (std::size_t k = 0; k < 6; ++k) {
                const glm::vec3 own = face == 0 ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
                const bool at_edge = patches.positions[scene.normals.size()] * glm::vec3(1, 1, 0) == glm::vec3(0.f);
                scene.normals.push_back(hard || !at_edge ? own : glm::normalize(glm::vec3(1, 1, 0)));
            }
        scene.looks.resize(1);
        scene.looks[0].smooth_normals = true;
        scene.triangle_look.assign(patches.triangles.size(), 0);
    }
    BoxEdge(const BoxEdge&) = delete;
};

TEST(SmoothCorners, AreJoinedOverSeamsOfTheSameNormalAndLook) {
    BoxEdge round(false), hard(true);
    EXPECT_EQ(smooth_corners(round.scene).count, 6u);
    EXPECT_EQ(smooth_corners(hard.scene).count, 8u);
    // A little rounding of positions' signs and of normals is none.
    for (glm::vec3& position : round.patches.positions)
        position = glm::vec3(position.x == 0 ? -0.f : position.x, position.y, position.z);
    round.scene.normals[1] = glm::normalize(round.scene.normals[1] + glm::vec3(1e-3f, 0, 0));
    EXPECT_EQ(smooth_corners(round.scene).count, 6u);
    round.scene.looks.push_back(round.scene.looks[0]);
    round.scene.triangle_look[2] = round.scene.triangle_look[3] = 1;
    EXPECT_EQ(smooth_corners(round.scene).count, 8u);
    round.scene.normals.clear(); // by place and look alone
    EXPECT_EQ(smooth_corners(round.scene).count, 8u);
    round.scene.triangle_look.assign(4, 0);
    EXPECT_EQ(smooth_corners(round.scene).count, 6u);
}

TEST(SmoothCorners, OfPositionsThatLooksShareAreApart) {
    BoxEdge edge(false);
    edge.patches.triangles[2] = edge.patches.triangles[0]; // the same three positions
    edge.scene.looks.push_back(edge.scene.looks[0]);
    edge.scene.triangle_look = {0, 0, 1, 1};
    const SmoothCorners corners = smooth_corners(edge.scene);
    std::set<std::uint32_t> of_one, of_other;
    for (std::size_t k = 0; k < 3; ++k) {
        of_one.insert(corners.of_triangle[0][k]);
        of_one.insert(corners.of_triangle[1][k]);
        of_other.insert(corners.of_triangle[2][k]);
        of_other.insert(corners.of_triangle[3][k]);
    }
    for (const std::uint32_t corner : of_one)
        EXPECT_EQ(of_other.count(corner), 0u);
    EXPECT_EQ(corners.count, of_one.size() + of_other.size());
}

TEST(SmoothCorners, KeepTheLightOfFacesThatMeetInAHardEdge) {
    const BoxEdge hard(true), round(false);
    const PictureOptions options = without_ground(8, 8, 16);
    const auto near_edge = [&](const BoxEdge& edge) { // what the upper face shows beside it
        return pixel(render_picture(edge.scene, RayQueries(edge.patches), constant_environment(glm::vec3(0.f)),
                                    camera_at({-0.02f, 1, 0}, {-0.02f, 0, 0}, 0.01f), options, quiet_corners)
                         .radiance,
                     4, 4)
            .r;
    };
    EXPECT_NEAR(near_edge(hard), 1, 1e-4);
    EXPECT_NEAR(near_edge(round), 0.5 * (1 + 0.25), 0.03); // the two faces' mean, at a round edge
}

} // namespace
} // namespace kokage::test

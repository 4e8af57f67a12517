// Error figures by hand-computed values.
#include "common/services/error.h"
#include "foliage/accuracy.h"
#include "tests/unit/common/scene_builders.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(Accuracy, HandComputedFigures) {
    // Two leaves; per channel the mean reference is 1, so that the floor is 0.05.
    const std::vector<glm::vec3> reference = {{2, 2, 2}, {1, 1, 1}, {1, 1, 1}, {0, 0, 0}};
    std::vector<glm::vec3> sides = reference;
    sides[0].r = 2.2f;  // 0.2 / 2     = 0.1
    sides[1].g = 0.5f;  // 0.5 / 1     = 0.5
    sides[3].b = 0.01f; // 0.01 / 0.05 = 0.2: the floor
    const Accuracy a = accuracy(sides, reference, {3, 1});
    EXPECT_NEAR(a.mre, 0.8 / 12, 1e-6);
    EXPECT_NEAR(a.p95, 0.5, 1e-6); // rank ceil(0.95 * 12) = 12 of 12
    EXPECT_NEAR(a.rmse_over_mean, std::sqrt((0.04 + 0.25 + 0.0001) / 12), 1e-6);
    // (3 * 0.2 - 3 * 0.5 + 1 * 0.01) / (3 * (2 + 1) * 3 channels + 1 * 1 * 3)
    EXPECT_NEAR(a.bias, -0.89 / 30, 1e-6);
}

TEST(Accuracy, PercentileLeavesOutTheWorstTwentieth) {
    std::vector<glm::vec3> reference(200, glm::vec3(1)), sides = reference; // 600 values
    for (int i = 0; i < 10; ++i)
        sides[std::size_t(i)] = glm::vec3(3); // the worst 30 of 600: exactly a twentieth
    EXPECT_EQ(accuracy(sides, reference, std::vector<double>(100, 1.0)).p95, 0);
    sides[10].r = 2;
    EXPECT_NEAR(accuracy(sides, reference, std::vector<double>(100, 1.0)).p95, 1, 1e-6);
}

TEST(Accuracy, PerfectBlackAndEmpty) {
    const std::vector<glm::vec3> black(4, glm::vec3(0));
    const Accuracy perfect = accuracy(black, black, {1, 1});
    EXPECT_EQ(perfect.mre, 0);
    EXPECT_EQ(perfect.bias, 0);
    const Accuracy wrong = accuracy(std::vector<glm::vec3>(4, glm::vec3(1)), black, {1, 1});
    EXPECT_EQ(wrong.mre, 1);
    EXPECT_TRUE(std::isfinite(wrong.bias) && std::isfinite(wrong.rmse_over_mean));
    EXPECT_EQ(accuracy({}, {}, {}).mre, 0);
    EXPECT_THROW(accuracy(black, black, {1}), InputError);
    EXPECT_THROW(accuracy({}, black, {1, 1}), InputError);
}

TEST(Accuracy, PatchesAverageBackToTheirLeafByArea) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {0, 0, 0}, {3, 0, 0}, {0, 1, 0}); // area 3
    test::add_rectangle(scene, {0, 2, 0}, {1, 0, 0}, {0, 1, 0}); // area 1
    test::add_leaf(scene, {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});    // no area
    test::add_rectangle(scene, {9, 2, 0}, {1, 0, 0}, {0, 1, 0}); // bark: not counted
    scene.patches[1].leaf = 0;
    scene.patches[2].leaf = 1;
    scene.patches[3].kind = PatchKind::bark;
    scene.leaf_count = 3;
    SideRadiance radiance;
    radiance.front = {glm::vec3(1, 0, 2), glm::vec3(5, 4, 2), glm::vec3(7), glm::vec3(100)};
    radiance.back = {glm::vec3(0), glm::vec3(8), glm::vec3(3), glm::vec3(100)};
    const std::vector<glm::vec3> sides = leaf_side_radiance(scene, radiance);
    ASSERT_EQ(sides.size(), 6u);
    EXPECT_EQ(sides[0], glm::vec3(2, 1, 2));
    EXPECT_EQ(sides[1], glm::vec3(2));
    EXPECT_EQ(sides[2], glm::vec3(7)) << "a leaf without area";
    EXPECT_EQ(sides[3], glm::vec3(3));
    EXPECT_EQ(sides[4], glm::vec3(0)) << "a leaf without patches";
    radiance.back.pop_back();
    EXPECT_THROW(leaf_side_radiance(scene, radiance), InputError);
}

} // namespace
} // namespace kokage

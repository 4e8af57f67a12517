#include "reflection/flat_patches.h"
#include "tests/unit/common/scene_builders.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

/// Corners of a rectangle's two triangles.
std::vector<glm::vec3> rectangle(const glm::vec3& corner, const glm::vec3& u, const glm::vec3& v) {
    return {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v};
}

bool is_flat(std::vector<glm::vec3> corners, const std::vector<glm::vec3>& more = {}) {
    PatchScene scene;
    add_leaf(scene, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}); // another patch before it
    corners.insert(corners.end(), more.begin(), more.end());
    add_leaf(scene, corners);
    return flat_patches(scene)[1] != 0;
}

/// Two halves of a leaf, each tilted by an angle.
std::vector<glm::vec3> folded(float angle, float size = 1, const glm::vec3& at = glm::vec3(0.f)) {
    const float across = size * std::cos(angle), up = size * std::sin(angle);
    std::vector<glm::vec3> corners = rectangle(at + glm::vec3(-across, up, 0), {across, -up, 0}, {0, 0, -size});
    for (const glm::vec3& corner : rectangle(at, {across, up, 0}, {0, 0, -size}))
        corners.push_back(corner);
    return corners;
}

TEST(FlatPatches, TellFlatFromBentLeaves) {
    EXPECT_TRUE(is_flat(folded(0)));
    EXPECT_TRUE(is_flat(folded(0.25f)));
    EXPECT_FALSE(is_flat(folded(0.4f)));
    EXPECT_FALSE(is_flat(folded(1.f)));
    EXPECT_TRUE(is_flat(folded(0, 0.01f, {300, 20, 300}))); // as far as digits go
    EXPECT_FALSE(is_flat(rectangle({0, 0, 0}, {1, 0, 0}, {0, 0, -1}), rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, -1})));
    EXPECT_FALSE(is_flat(rectangle({0, 0, 0}, {1, 0, 0}, {0, 0, -1}), rectangle({0, 0, -1}, {1, 0, 0}, {0, 0, 1})));
}

TEST(FlatPatches, AreNotMadeBentBySlivers) {
    EXPECT_TRUE(is_flat(folded(0), {{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-6f, 0}}));
    EXPECT_TRUE(is_flat(folded(0), {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
    EXPECT_TRUE(is_flat({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}));
}

TEST(FlatPatches, AreNotRoundedOnesOfManyTriangles) {
    std::vector<glm::vec3> strip; // a half circle in steps of half a degree
    for (int k = 0; k < 360; ++k) {
        const float from = kPi * float(k) / 360, to = kPi * float(k + 1) / 360;
        const glm::vec3 a(std::cos(from), std::sin(from), 0), b(std::cos(to), std::sin(to), 0);
        for (const glm::vec3& corner : rectangle(a, b - a, {0, 0, 1}))
            strip.push_back(corner);
    }
    EXPECT_FALSE(is_flat(strip));
}

} // namespace
} // namespace kokage::test

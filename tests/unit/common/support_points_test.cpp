// The farthest points in many directions, against a search through all points.
#include "common/geometry/support_points.h"

#include "common/services/random.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

glm::vec3 random_place(Random& random) {
    const float x = random.uniform(), y = random.uniform();
    return {x, y, random.uniform()};
}

std::vector<glm::vec3> random_directions(Random& random, int count) {
    std::vector<glm::vec3> directions;
    for (int i = 0; i < count; ++i)
        directions.push_back(2.f * random_place(random) - 1.f);
    return directions;
}

float reach(const std::vector<glm::vec3>& points, const glm::vec3& direction) {
    float farthest = -std::numeric_limits<float>::infinity();
    for (const glm::vec3& point : points)
        farthest = std::max(farthest, glm::dot(point, direction));
    return farthest;
}

TEST(SupportPoints, ReachAsFarAsAllPointsInEveryDirection) {
    Random random(1, 0);
    for (int count : {1, 2, 30, 5000})
        for (const glm::vec3& shape : {glm::vec3(1, 1, 1), glm::vec3(5, 0.1f, 2), glm::vec3(1, 0, 1)}) {
            std::vector<glm::vec3> points;
            for (int i = 0; i < count; ++i)
                points.push_back(shape * random_place(random) + glm::vec3(-3, 0, 2));
            const std::vector<glm::vec3> directions = random_directions(random, 200);
            const std::vector<std::uint32_t> found = support_points(points, directions);
            ASSERT_FALSE(found.empty());
            EXPECT_LE(found.size(), std::min(points.size(), directions.size()));
            EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
            EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
            std::vector<glm::vec3> support;
            for (const std::uint32_t i : found)
                support.push_back(points.at(i));
            for (const glm::vec3& direction : directions)
                EXPECT_NEAR(reach(support, direction), reach(points, direction), 1e-5f);
        }
}

TEST(SupportPoints, OnlyWhatIsFarthestSomewhere) {
    Random random(2, 0);
    std::vector<glm::vec3> points;
    for (unsigned k = 0; k < 8; ++k)
        points.emplace_back(k & 1, k >> 1 & 1, k >> 2 & 1);
    for (int i = 0; i < 1000; ++i)
        points.push_back(0.05f + 0.9f * random_place(random));
    const std::vector<std::uint32_t> found = support_points(points, random_directions(random, 500));
    EXPECT_EQ(found, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(SupportPoints, NonsenseIsLeftOut) {
    const float nan = std::nanf(""), infinity = std::numeric_limits<float>::infinity();
    const std::vector<glm::vec3> directions{{1, 0, 0}, {-1, 0, 0}};
    EXPECT_TRUE(support_points({}, directions).empty());
    const std::vector<glm::vec3> nowhere{{nan, 0, 0}, {0, infinity, 0}};
    EXPECT_TRUE(support_points(nowhere, directions).empty());
    const std::vector<glm::vec3> some{{infinity, 0, 0}, {1, 0, 0}, {nan, 0, 0}, {0, 0, 0}};
    EXPECT_EQ(support_points(some, directions), (std::vector<std::uint32_t>{1, 3}));
}

} // namespace
} // namespace kokage

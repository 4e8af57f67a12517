#include "foliage/convergence.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(Convergence, StopsWhenTheResidualIsSmallEnough) {
    Convergence convergence(0, 0.01);
    int bounces = 0;
    double change = 1;
    while (convergence.another({change, 2})) {
        change *= 0.5;
        ++bounces;
    }
    EXPECT_EQ(bounces, 6); // 0.5 x 2^-6 is the first below 0.01
    EXPECT_NEAR(*convergence.rate(), 0.5, 1e-12);
    EXPECT_TRUE(convergence.warning().empty());
}

TEST(Convergence, DoesExactlyAsManyBouncesAsAsked) {
    Convergence convergence(4, 0.01);
    int bounces = 1;
    while (convergence.another({1e-9, 1}))
        ++bounces;
    EXPECT_EQ(bounces, 4);
}

TEST(Convergence, EndsWhenNothingChanges) {
    Convergence convergence(0, 0.01);
    EXPECT_FALSE(convergence.another({0, 0}));
    EXPECT_EQ(convergence.residuals(), std::vector<double>{0});
}

TEST(Convergence, SaysPlainlyWhenItDiverges) {
    Convergence convergence(0, 0.01);
    double change = 1, radiance = 1;
    int bounces = 0;
    while (convergence.another({change, radiance})) {
        change *= 1.2;
        radiance += change;
        ASSERT_LT(++bounces, 100);
    }
    EXPECT_TRUE(convergence.diverges());
    EXPECT_NE(convergence.warning().find("does not contract"), std::string::npos);
    EXPECT_NE(convergence.warning().find("1.200"), std::string::npos);
}

TEST(Convergence, StopsBeforeNumbersLeaveTheRangeOfFloat) {
    Convergence convergence(1000, 0.01);
    double change = 1;
    while (convergence.another({change, change}))
        change *= 10;
    EXPECT_LT(change, 1e35);
    EXPECT_FALSE(convergence.warning().empty());
}

TEST(CompareBounces, FindsTheLargestChangeOfAnySideAndChannel) {
    SideRadiance before{std::vector<glm::vec3>(9000, glm::vec3(1)), std::vector<glm::vec3>(9000, glm::vec3(2))},
        after = before;
    after.back[8000].g = 5;
    after.front[10].r = 0.5f;
    const BounceChange change = compare_bounces(before, after);
    EXPECT_EQ(change.largest_change, 3);
    EXPECT_EQ(change.largest_radiance, 5);
}

} // namespace
} // namespace kokage

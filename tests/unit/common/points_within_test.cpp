// Points within a distance: against a loop over all of them.
#include "common/geometry/point_tree.h"
#include "common/services/random.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

TEST(PointsWithin, AreThoseThatALoopFinds) {
    Random random(5);
    std::vector<glm::vec3> points;
    GrowingPointTree growing;
    for (int i = 0; i < 700; ++i) { // on a coarse grid: many at one place, many at one distance
        points.emplace_back(random.below(9), random.below(9), random.below(9));
        growing.add(points.back());
    }
    const PointTree tree(points);
    std::size_t all = 0;
    for (int i = 0; i < 200; ++i) {
        const glm::vec3 place(random.below(9), random.below(9), random.uniform(0.f, 9.f));
        const float distance = float(random.below(5));
        std::vector<std::uint32_t> expected;
        for (std::uint32_t p = 0; p < points.size(); ++p) {
            const glm::dvec3 off = glm::dvec3(points[p]) - glm::dvec3(place);
            if (glm::dot(off, off) <= double(distance) * double(distance))
                expected.push_back(p);
        }
        EXPECT_EQ(tree.within(place, distance), expected);
        EXPECT_EQ(growing.within(place, distance), expected);
        all += expected.size();
    }
    EXPECT_GT(all, 1000u);
    EXPECT_TRUE(PointTree().within(glm::vec3(0.f), 1.f).empty());
    EXPECT_TRUE(GrowingPointTree().within(glm::vec3(0.f), 1.f).empty());
}

} // namespace
} // namespace kokage

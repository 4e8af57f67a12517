#include "common/geometry/polygon.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

glm::dvec3 area_vector(const std::vector<glm::dvec3>& corners, const std::vector<glm::uvec3>& triangles, double& sum) {
    glm::dvec3 total(0.0);
    sum = 0;
    for (const glm::uvec3& t : triangles) {
        const glm::dvec3 area = 0.5 * glm::cross(corners[t.y] - corners[t.x], corners[t.z] - corners[t.x]);
        total += area;
        sum += glm::length(area);
    }
    return total;
}

/// The area vector of the polygon itself, and that of its triangles: equal, and no triangle turned over.
void expect_covered(const std::vector<glm::dvec3>& corners) {
    const std::vector<glm::uvec3> triangles = triangulate_polygon(corners);
    ASSERT_EQ(triangles.size(), corners.size() - 2);
    glm::dvec3 polygon(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i)
        polygon += 0.5 * glm::cross(corners[i], corners[(i + 1) % corners.size()]);
    double sum = 0;
    const glm::dvec3 total = area_vector(corners, triangles, sum);
    EXPECT_LT(glm::length(total - polygon), 1e-12 * sum);
    EXPECT_NEAR(sum, glm::length(polygon), 1e-12 * sum) << "triangles overlap";
}

TEST(Polygon, ConvexAndConcavePolygonsAreCoveredOnce) {
    expect_covered({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    for (std::size_t start = 0; start < 4; ++start) { // an arrow head, from every corner
        const std::vector<glm::dvec3> arrow{{0, 0, 1}, {2, 1, 1}, {0, 2, 1}, {0.8, 1, 1}};
        std::vector<glm::dvec3> turned;
        for (std::size_t i = 0; i < 4; ++i)
            turned.push_back(arrow[(start + i) % 4]);
        expect_covered(turned);
        expect_covered({turned[3], turned[2], turned[1], turned[0]});
    }
    // A star and a comb, in tilted planes.
    std::vector<glm::dvec3> star, comb;
    for (int i = 0; i < 40; ++i) {
        const double angle = i * 2 * M_PI / 40, radius = i % 2 ? 0.3 : 1;
        const double x = radius * std::cos(angle), y = radius * std::sin(angle);
        star.emplace_back(x, 0.5 * y + 0.2 * x, y);
    }
    for (int i = 0; i < 10; ++i)
        comb.emplace_back(i, i % 2 ? 0.1 : 5, 0.3 * i);
    comb.emplace_back(9, -1, 2.7);
    comb.emplace_back(0, -1, 0);
    expect_covered(star);
    expect_covered(comb);
}

TEST(Polygon, WhatHasNoAreaOrCrossesItselfStillGivesTriangles) {
    EXPECT_TRUE(triangulate_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}}).empty());
    EXPECT_EQ(triangulate_polygon(std::vector<glm::dvec3>(7, glm::dvec3(1))).size(), 5u);
    EXPECT_EQ(triangulate_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}).size(), 2u);
    const std::vector<glm::uvec3> quad =
        triangulate_polygon(std::vector<glm::dvec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    EXPECT_EQ(quad[0], glm::uvec3(0, 1, 2));
    EXPECT_EQ(quad[1], glm::uvec3(0, 2, 3));
}

} // namespace
} // namespace kokage

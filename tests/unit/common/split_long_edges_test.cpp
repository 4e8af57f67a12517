#include "common/geometry/split_long_edges.h"
#include "common/geometry/triangle_topology.h"

#include <gtest/gtest.h>

#include <map>

namespace kokage {
namespace {

struct Mesh {
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> middles;
    std::vector<std::uint32_t> source;
    void split(double longest, std::size_t most = 1 << 20) {
        split_long_edges(longest, most, positions, triangles, middles, source);
    }
    double area() const {
        double sum = 0;
        for (const glm::uvec3& t : triangles)
            sum +=
                0.5 * double(glm::length(glm::cross(positions[t.y] - positions[t.x], positions[t.z] - positions[t.x])));
        return sum;
    }
};

/// A box; every face has corners of its own, as where texture coordinates differ.
Mesh box(const glm::vec3& size) {
    Mesh mesh;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
            const auto first = std::uint32_t(mesh.positions.size());
            for (int k = 0; k < 4; ++k) {
                glm::vec3 corner(0.f);
                corner[axis] = side ? size[axis] : 0.f;
                corner[(axis + 1) % 3] = k == 1 || k == 2 ? size[(axis + 1) % 3] : 0.f;
                corner[(axis + 2) % 3] = k >= 2 ? size[(axis + 2) % 3] : 0.f;
                mesh.positions.push_back(corner);
            }
            mesh.triangles.insert(mesh.triangles.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
        }
    return mesh;
}

TEST(SplitLongEdges, ABoxKeepsItsShapeAndStaysClosed) {
    Mesh mesh = box({1, 0.3f, 2});
    const double area = mesh.area();
    mesh.split(0.17);
    EXPECT_NEAR(mesh.area(), area, 1e-5);
    const std::vector<std::uint32_t> welded = weld(mesh.positions);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const glm::uvec3& t : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            const std::uint32_t a = welded[t[k]], b = welded[t[(k + 1) % 3]];
            EXPECT_LE(glm::distance(mesh.positions[a], mesh.positions[b]), 0.1701f);
            ++edges[std::minmax(a, b)];
        }
    for (const auto& [edge, count] : edges)
        EXPECT_EQ(count, 2); // no edge that only one side has: no cracks
    ASSERT_EQ(mesh.source.size(), mesh.triangles.size());
    for (std::size_t t = 1; t < mesh.source.size(); ++t)
        EXPECT_LE(mesh.source[t - 1], mesh.source[t]);
    for (std::size_t i = 0; i < mesh.middles.size(); ++i) {
        const auto [a, b] = mesh.middles[i];
        EXPECT_LT(std::max(a, b), 24 + i);
        EXPECT_EQ(mesh.positions[24 + i], 0.5f * (mesh.positions[a] + mesh.positions[b]));
    }
}

TEST(SplitLongEdges, WhatIsFineStaysAsItIs) {
    Mesh mesh = box({1, 1, 1});
    const std::vector<glm::uvec3> before = mesh.triangles;
    mesh.split(2);
    EXPECT_EQ(mesh.triangles, before);
    EXPECT_TRUE(mesh.middles.empty());
}

TEST(SplitLongEdges, EndsWhereThereAreTooManyOrNothingToSplit) {
    Mesh mesh = box({1, 1, 1});
    mesh.split(1e-9, 1000);
    EXPECT_GT(mesh.triangles.size(), 1000u);
    EXPECT_LE(mesh.triangles.size(), 4000u);
    Mesh empty;
    empty.split(1);
    EXPECT_TRUE(empty.triangles.empty());
    Mesh line;
    line.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
    line.triangles = {{0, 1, 2}};
    line.split(0.1);
    EXPECT_GT(line.triangles.size(), 1u);
}

} // namespace
} // namespace kokage

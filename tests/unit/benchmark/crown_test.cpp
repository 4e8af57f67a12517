#include "tests/benchmark/crown.h"
#include "tests/benchmark/crown_skeleton.h"

#include <cstring>
#include <gtest/gtest.h>
#include <numeric>

namespace kokage {
namespace {

/// Area of the leaves' shadow from straight above, by testing a grid of points against every kite's hull: the slow twin
/// of the convex hull is a grid over which a point counts as inside when leaf centres lie on all sides of it.
double hull_area_on_a_grid(const std::vector<Leaf>& leaves, int directions) {
    // A point is in the hull when, for every direction, it is not beyond the farthest leaf: an intersection of
    // half-planes.
    std::vector<glm::dvec3> planes; // direction and its support
    for (int i = 0; i < directions; ++i) {
        const double angle = 2 * kPiDouble * i / directions;
        const glm::dvec2 d(std::cos(angle), std::sin(angle));
        double support = -1e30;
        for (const Leaf& leaf : leaves)
            support = std::max(support, d.x * leaf.centre.x + d.y * leaf.centre.z);
        planes.push_back({d.x, d.y, support});
    }
    int inside = 0;
    constexpr int cells = 500;
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x) {
            const double px = -6 + 12 * (x + 0.5) / cells, py = -6 + 12 * (y + 0.5) / cells;
            bool in = true;
            for (const auto& plane : planes)
                in = in && plane.x * px + plane.y * py <= plane.z;
            inside += in;
        }
    return 144.0 * inside / (cells * cells);
}

class BenchCrown : public testing::TestWithParam<std::uint32_t> {};

TEST_P(BenchCrown, has_the_leaves_and_the_leaf_area_that_it_says) {
    const Tree tree = make_bench_crown(GetParam(), 1);
    ASSERT_EQ(tree.leaves.size(), GetParam());
    ASSERT_EQ(tree.parts.size(), 2u);
    EXPECT_EQ(tree.parts[0].triangles.size(), 2u * GetParam());
    const double projection = ground_projection_area(tree.leaves);
    EXPECT_NEAR(foliage_area(tree) / projection, 3.5, 0.002);
    EXPECT_NEAR(hull_area_on_a_grid(tree.leaves, 360) / projection, 1.0, 0.01);
    for (std::size_t i = 0; i < tree.leaves.size(); ++i) {
        const Branch& twig = tree.skeleton.branches.at(std::size_t(tree.leaves[i].branch));
        EXPECT_GE(twig.order, 3);
        glm::dvec3 centroid(0.0);
        for (std::size_t t = 2 * i; t < 2 * i + 2; ++t) {
            ASSERT_EQ(tree.parts[0].triangle_patch[t], i);
            for (int corner = 0; corner < 3; ++corner)
                centroid += glm::dvec3(tree.parts[0].positions[tree.parts[0].triangles[t][std::size_t(corner)]]) / 6.0;
        }
        ASSERT_LT(glm::length(glm::vec3(centroid) - tree.leaves[i].centre), 1e-4f);
    }
}

TEST_P(BenchCrown, bark_patches_are_numbered_consecutively_and_skeleton_is_ordered) {
    const Tree tree = make_bench_crown(GetParam(), 1);
    const auto& patch = tree.parts[1].triangle_patch;
    ASSERT_EQ(patch.size(), tree.parts[1].triangles.size());
    std::uint32_t expected = 0;
    for (std::size_t t = 0; t < patch.size(); ++t) {
        if (patch[t] != expected) {
            ++expected;
        }
        ASSERT_EQ(patch[t], expected) << "triangle " << t;
    }
    EXPECT_EQ(expected + 1, tree.bark_patch_count);
    for (std::size_t b = 1; b < tree.skeleton.branches.size(); ++b) {
        const Branch& branch = tree.skeleton.branches[b];
        ASSERT_GE(branch.parent, 0);
        ASSERT_LT(branch.parent, std::int32_t(b));
        EXPECT_EQ(branch.order, tree.skeleton.branches[std::size_t(branch.parent)].order + 1);
        EXPECT_GT(branch.nodes.back().radius_m, 0.f);
    }
}

INSTANTIATE_TEST_SUITE_P(sizes, BenchCrown, testing::Values(100u, 5000u, 30000u));

TEST(BenchCrownShape, is_the_same_bytes_every_time_and_another_tree_for_another_seed) {
    const Tree a = make_bench_crown(5000, 1), b = make_bench_crown(5000, 1), other = make_bench_crown(5000, 2);
    for (int part = 0; part < 2; ++part) {
        const auto &x = a.parts[std::size_t(part)].positions, &y = b.parts[std::size_t(part)].positions;
        ASSERT_EQ(x.size(), y.size());
        EXPECT_EQ(0, std::memcmp(x.data(), y.data(), x.size() * sizeof x[0]));
    }
    EXPECT_NE(a.leaves[0].centre, other.leaves[0].centre);
}

TEST(BenchCrownShape, limbs_and_branches_are_the_same_for_any_number_of_leaves) {
    const Skeleton small = make_bench_skeleton(417, 1), large = make_bench_skeleton(2500, 1);
    for (std::size_t b = 0; b < 1 + 16 + 128; ++b) {
        ASSERT_EQ(small.branches[b].nodes.size(), large.branches[b].nodes.size());
        for (std::size_t n = 0; n < small.branches[b].nodes.size(); ++n)
            EXPECT_EQ(small.branches[b].nodes[n].position, large.branches[b].nodes[n].position);
    }
    const Tree few = make_bench_crown(5000, 1), many = make_bench_crown(30000, 1);
    EXPECT_NEAR(ground_projection_area(few.leaves) / ground_projection_area(many.leaves), 1.0, 0.15);
}

TEST(BenchCrownShape, one_leaf_is_enough) {
    const Tree tree = make_bench_crown(1, 1);
    EXPECT_EQ(tree.leaves.size(), 1u);
    EXPECT_GT(foliage_area(tree), 0.0);
}

} // namespace
} // namespace kokage

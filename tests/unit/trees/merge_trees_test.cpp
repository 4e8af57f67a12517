#include "common/services/error.h"
#include "trees/growth.h"
#include "trees/merge_trees.h"
#include "trees/patches.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

Tree seeded_oak(std::uint64_t seed) {
    GrowthParameters parameters = find_species("oak").parameters;
    parameters.leaves = 60;
    parameters.seed = seed;
    return grow(parameters);
}

/// Adds the tree's own materials, too.
void add_with_materials(Tree& all, const Tree& tree, const TreePlacement& placement) {
    MaterialNumbers numbers;
    for (const TreeMaterial& material : tree.materials) {
        numbers.bark.push_back(std::uint32_t(all.materials.size()));
        all.materials.push_back(material);
    }
    numbers.foliage = numbers.bark;
    add_tree(all, tree, placement, numbers);
}

TEST(MergeTrees, PointsAreScaledTurnedAndMoved) {
    TreePlacement placement;
    placement.foot = {1, 2, 3};
    placement.at = {10, 0, -5};
    placement.turn_degrees = 90;
    placement.size = 2;
    // +Z goes to +X, +X to -Z.
    const glm::dvec3 from_z = placed_point(placement, {1, 2, 4}, {0, 0, 0});
    EXPECT_LT(glm::distance(from_z, glm::dvec3(12, 0, -5)), 1e-12);
    const glm::dvec3 from_x = placed_point(placement, {2, 3, 3}, {10, 0, 0});
    EXPECT_LT(glm::distance(from_x, glm::dvec3(0, 2, -7)), 1e-12);
    EXPECT_LT(glm::distance(placed_direction(placement, {0, 0, 1}), glm::dvec3(1, 0, 0)), 1e-12);
}

TEST(MergeTrees, EveryLeafAndPatchOfBothIsThere) {
    const Tree one = seeded_oak(1), two = seeded_oak(2);
    Tree all;
    TreePlacement there;
    there.at = {7, 1, 2};
    there.turn_degrees = 33;
    there.size = 1.5;
    add_with_materials(all, one, {});
    add_with_materials(all, two, there);
    ASSERT_EQ(all.leaves.size(), one.leaves.size() + two.leaves.size());
    ASSERT_EQ(all.skeleton.branches.size(), one.skeleton.branches.size() + two.skeleton.branches.size());
    EXPECT_EQ(all.bark_patch_count, one.bark_patch_count + two.bark_patch_count);
    const auto first_branch = std::int32_t(one.skeleton.branches.size());
    for (std::size_t i = 0; i < two.leaves.size(); ++i) {
        const Leaf& leaf = all.leaves[one.leaves.size() + i];
        EXPECT_EQ(leaf.branch, two.leaves[i].branch + first_branch);
        const glm::dvec3 expected = placed_point(there, glm::dvec3(two.leaves[i].centre), glm::dvec3(0.0));
        EXPECT_LT(glm::distance(glm::dvec3(leaf.centre), expected), 1e-5);
    }
    int roots = 0;
    for (std::size_t b = 0; b < all.skeleton.branches.size(); ++b) {
        const Branch& branch = all.skeleton.branches[b];
        roots += branch.parent < 0;
        EXPECT_LT(branch.parent, std::int32_t(b));
        if (b >= one.skeleton.branches.size()) {
            const Branch& own = two.skeleton.branches[b - one.skeleton.branches.size()];
            EXPECT_EQ(branch.parent < 0, own.parent < 0);
            EXPECT_FLOAT_EQ(branch.nodes[0].radius_m, 1.5f * own.nodes[0].radius_m);
        }
    }
    EXPECT_EQ(roots, 2);
    // What transport sees: leaves of one, leaves of two, bark of one, bark of two; areas grow with the square of size.
    const PatchScene merged = make_patches(all), alone = make_patches(two);
    const std::vector<double> areas = solid_areas(merged), own_areas = solid_areas(alone);
    for (std::size_t i = 0; i < two.leaves.size(); ++i)
        EXPECT_NEAR(areas[one.leaves.size() + i], 2.25 * own_areas[i], 1e-4 * own_areas[i]);
    EXPECT_EQ(merged.patches.size(), make_patches(one).patches.size() + alone.patches.size());
}

TEST(MergeTrees, FarFromTheOriginNothingIsLost) {
    const Tree tree = seeded_oak(1);
    Tree near, far;
    TreePlacement placement;
    add_with_materials(near, tree, placement);
    placement.at = {5e6, 120, -3e6};
    far.origin = placement.at;
    add_with_materials(far, tree, placement);
    for (std::size_t p = 0; p < near.parts.size(); ++p)
        EXPECT_EQ(near.parts[p].positions, far.parts[p].positions);
}

TEST(MergeTrees, MaterialsWithoutNumbersAreRefused) {
    const Tree tree = seeded_oak(1);
    Tree all;
    EXPECT_THROW(add_tree(all, tree, {}, {}), InputError);
}

} // namespace
} // namespace kokage

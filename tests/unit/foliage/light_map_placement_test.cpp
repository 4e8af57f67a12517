#include "common/services/error.h"
#include "foliage/light_map_placement.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

/// A trunk with two limbs (order 1), three branches (order 2), four twigs (order 3) and a leafless shoot (order 4).
Tree hand_made_tree() {
    Tree tree;
    Skeleton& s = tree.skeleton;
    test::add_branch(s, -1, {0, 0, 0}, {0, 10, 0}, 0.5f);  // 0, order 0
    test::add_branch(s, 0, {0, 6, 0}, {4, 8, 0}, 0.2f);    // 1, order 1
    test::add_branch(s, 0, {0, 4, 0}, {-4, 6, 0}, 0.2f);   // 2, order 1: the lowest
    test::add_branch(s, 1, {2, 7, 0}, {2, 9, 0}, 0.1f);    // 3, order 2
    test::add_branch(s, 1, {4, 8, 0}, {5, 9, 0}, 0.1f);    // 4, order 2
    test::add_branch(s, 2, {-4, 6, 0}, {-5, 7, 0}, 0.1f);  // 5, order 2
    test::add_branch(s, 3, {2, 8, 0}, {2, 8, 1}, 0.05f);   // 6, order 3
    test::add_branch(s, 3, {2, 9, 0}, {2, 10, 0}, 0.05f);  // 7, order 3
    test::add_branch(s, 4, {5, 9, 0}, {6, 9, 0}, 0.05f);   // 8, order 3
    test::add_branch(s, 5, {-5, 7, 0}, {-6, 7, 0}, 0.05f); // 9, order 3
    test::add_branch(s, 9, {-6, 7, 0}, {-9, 7, 0}, 0.01f); // 10, order 4, no leaves
    const auto leaf = [&](std::int32_t branch, const glm::vec3& centre) { tree.leaves.push_back({centre, branch}); };
    leaf(6, {2, 8, 2});
    leaf(7, {2, 11, 0});
    leaf(8, {7, 9, 0});
    leaf(9, {-8, 7, 0});
    return tree;
}

std::vector<std::int32_t> branches_of(const LightMapPlacement& placement) {
    std::vector<std::int32_t> branches;
    for (const LightMapPlace& place : placement.places)
        branches.push_back(place.branch);
    return branches;
}

TEST(LightMapPlacement, FindsTheLastGenerationThatBearsLeaves) {
    EXPECT_EQ(place_light_maps(hand_made_tree(), 3).last_generation, 3);
}

TEST(LightMapPlacement, TakesGenerationsOneAndTheLastTwo) {
    const LightMapPlacement placement = place_light_maps(hand_made_tree(), 100);
    EXPECT_EQ(placement.candidates, 9u); // all but the trunk and the leafless shoot
    for (const LightMapPlace& place : placement.places)
        EXPECT_TRUE(place.generation == 1 || place.generation == 2 || place.generation == 3);

    // One more generation of leaves: now 1, 3 and 4, and those of order 2 drop out.
    Tree deeper = hand_made_tree();
    deeper.leaves.push_back({{-9, 7, 0}, 10});
    const LightMapPlacement other = place_light_maps(deeper, 100);
    EXPECT_EQ(other.last_generation, 4);
    EXPECT_EQ(other.candidates, 7u);
    for (const LightMapPlace& place : other.places)
        EXPECT_NE(place.generation, 2);
}

TEST(LightMapPlacement, StartsLowestInTheFirstGenerationAndGoesFarthest) {
    // From (0,4,0): the farthest candidate is branch 8 at (5,9,0), distance 7.07. Then branch 9 at (-5,7,0):
    // min(5.83, 10.2).
    const LightMapPlacement placement = place_light_maps(hand_made_tree(), 3);
    EXPECT_EQ(branches_of(placement), (std::vector<std::int32_t>{2, 8, 9}));
}

TEST(LightMapPlacement, APrefixIsThePlacementOfFewer) {
    const std::vector<std::int32_t> all = branches_of(place_light_maps(hand_made_tree(), 100));
    for (int count = 1; count <= int(all.size()); ++count)
        EXPECT_EQ(branches_of(place_light_maps(hand_made_tree(), count)),
                  std::vector<std::int32_t>(all.begin(), all.begin() + count));
}

TEST(LightMapPlacement, TiesGoToTheLowerIndex) {
    Tree tree;
    test::add_branch(tree.skeleton, -1, {0, 0, 0}, {0, 3, 0});
    test::add_branch(tree.skeleton, 0, {0, 1, 0}, {1, 1, 0});
    for (const glm::vec3& at : {glm::vec3(2, 1, 0), glm::vec3(-2, 1, 0), glm::vec3(0, 1, 2)})
        test::add_branch(tree.skeleton, 1, at, at);
    tree.leaves.push_back({{2, 1, 0}, 2});
    EXPECT_EQ(branches_of(place_light_maps(tree, 3)), (std::vector<std::int32_t>{1, 2, 3}));
}

TEST(LightMapPlacement, CopiesOfAPointAreTakenOnce) {
    Tree tree;
    test::add_branch(tree.skeleton, -1, {0, 0, 0}, {0, 3, 0});
    for (int i = 0; i < 5; ++i)
        test::add_branch(tree.skeleton, 0, {0, 2, 0}, {1, 2, 0});
    EXPECT_EQ(place_light_maps(tree, 5).places.size(), 1u);
}

TEST(LightMapPlacement, SphereHoldsNinetyFivePercentOfTheSubtreesLeaves) {
    Tree tree;
    test::add_branch(tree.skeleton, -1, {0, 0, 0}, {0, 3, 0}, 0.3f);
    test::add_branch(tree.skeleton, 0, {0, 1, 0}, {5, 1, 0}, 0.1f);
    test::add_branch(tree.skeleton, 1, {5, 1, 0}, {6, 1, 0}, 0.05f);
    for (int i = 1; i <= 100; ++i)
        tree.leaves.push_back({{float(i), 1, 0}, 2}); // at distance i from branch 1, on its child
    tree.leaves.push_back({{0, 2000, 0}, 0});         // on the trunk: of no subtree
    tree.leaves.push_back({{0, 3000, 0}, -1});        // borne by nobody knows what
    const LightMapPlacement placement = place_light_maps(tree, 1);
    ASSERT_EQ(placement.places[0].branch, 1);
    EXPECT_FLOAT_EQ(placement.places[0].radius_m, 95);
    EXPECT_FLOAT_EQ(placement.places[0].clearance_m, 0.3f); // the trunk's wood surrounds the branching point
}

TEST(LightMapPlacement, ABranchWithoutLeavesHasNoSphere) {
    Tree tree = hand_made_tree();
    test::add_branch(tree.skeleton, 0, {0, 1, 0}, {9, 1, 0});
    const LightMapPlacement placement = place_light_maps(tree, 1);
    EXPECT_EQ(placement.places[0].branch, 11);
    EXPECT_EQ(placement.places[0].radius_m, 0);
}

TEST(LightMapPlacement, IsTheSameEveryTime) {
    const test::SmallTree small = test::ball_on_a_skeleton(500, 2, test::realistic_leaf());
    const LightMapPlacement first = place_light_maps(small.tree, 40), second = place_light_maps(small.tree, 40);
    EXPECT_EQ(branches_of(first), branches_of(second));
    EXPECT_EQ(first.places.size(), 40u);
}

TEST(LightMapPlacement, WithoutBranchingOneMapStandsAtTheLeavesCentre) {
    Tree tree;
    tree.leaves = {{{1, 2, 3}, -1}, {{3, 2, 3}, -1}};
    const LightMapPlacement placement = place_light_maps(tree, 15);
    ASSERT_EQ(placement.places.size(), 1u);
    EXPECT_EQ(placement.places[0].position, glm::vec3(2, 2, 3));
    EXPECT_FLOAT_EQ(placement.places[0].radius_m, 1);
    EXPECT_NE(placement.note.find("no branching points"), std::string::npos);
}

TEST(LightMapPlacement, SaysWhenBranchingWasInferred) {
    Tree tree = hand_made_tree();
    EXPECT_TRUE(place_light_maps(tree, 3).note.empty());
    tree.branching_known = false;
    EXPECT_NE(place_light_maps(tree, 3).note.find("inferred"), std::string::npos);
}

TEST(LightMapPlacement, EmptyTreeHasNoPlaces) {
    EXPECT_TRUE(place_light_maps(Tree{}, 15).places.empty());
}

TEST(LightMapPlacement, RefusesNoMaps) {
    EXPECT_THROW(place_light_maps(hand_made_tree(), 0), InputError);
}

TEST(Percentile, IsTheNearestRank) {
    EXPECT_EQ(percentile({}, 0.95), 0);
    EXPECT_EQ(percentile({4}, 0.95), 4);
    EXPECT_EQ(percentile({3, 1, 2, 4}, 0.5), 2);
    EXPECT_EQ(percentile({3, 1, 2, 4}, 1), 4);
    EXPECT_EQ(percentile({3, 1, 2, 4}, 0), 1);
}

} // namespace
} // namespace kokage

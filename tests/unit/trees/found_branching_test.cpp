// Our own trees with everything but their meshes taken away: leaves and generations are found again.
#include "tests/support/foreign_copy.h"
#include "trees/growth.h"
#include "trees/species.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

Tree grown_with(const std::string& species, int leaves,
                const std::vector<std::pair<const char*, std::string>>& settings) {
    GrowthParameters parameters = find_species(species).parameters;
    parameters.leaves = leaves;
    for (const auto& [name, value] : settings)
        set_parameter(parameters, name, value);
    return grow(parameters);
}

/// The measure that the requirement of 80 % is about: see compare_generations().
void expect_generations(const Tree& truth, double least_share, std::uint64_t shuffle) {
    const Tree found = found_again(truth, shuffle);
    EXPECT_EQ(found.leaves.size(), truth.leaves.size()) << truth.source;
    EXPECT_FALSE(found.branching_known);
    const GenerationAgreement agreement = compare_generations(truth, found);
    std::string wrong;
    for (const auto& [orders, branches] : agreement.orders)
        if (orders.first != orders.second)
            wrong += " order " + std::to_string(orders.first) + " found as " + std::to_string(orders.second) + ": " +
                     std::to_string(branches) + ";";
    EXPECT_GT(agreement.bearing, truth.leaves.size() / 30) << truth.source;
    EXPECT_GE(agreement.share(), least_share)
        << truth.source << ": " << agreement.of_order << " of " << agreement.bearing << ";" << wrong;
}

// Measured: trees of ten species, 2,000 to 10,000 leaves and three seeds agree wholly.
TEST(FoundBranching, GenerationsOfEverySpeciesAgree) {
    for (const Species& species : all_species())
        expect_generations(grown_with(species.name, 2500, {}), 0.99, 7);
}

// Where branches stand so close that the nearest sample of an axis is often another branch's than the one that passes
// through the place, or where wood at a branching point is just 1/256 of a metre thick.
TEST(FoundBranching, GenerationsInCrowdedCrownsAgree) {
    expect_generations(grown_with("cypress", 4000, {}), 0.999, 3);
    expect_generations(grown_with("cypress", 4000, {{"seed", "2"}}), 0.999, 3);
    expect_generations(grown_with("cherry", 10000, {{"seed", "3"}}), 0.999, 3);
}

TEST(FoundBranching, GenerationsOfAnySeedAndSizeAgree) {
    expect_generations(grown_with("oak", 1000, {{"seed", "2"}}), 0.95, 1);
    expect_generations(grown_with("oak", 4000, {{"seed", "3"}}), 0.95, 2);
    expect_generations(grown_with("oak", 15000, {{"seed", "4"}}), 0.95, 3);
}

TEST(FoundBranching, GenerationsOfAlphaCardsAgree) {
    expect_generations(grown_with("oak", 3000, {{"leaf_form", "alpha"}, {"seed", "5"}}), 0.95, 4);
}

TEST(FoundBranching, DoesNotDependOnTheOrderOfTheFile) {
    const Tree truth = grown_with("oak", 1500, {});
    const Tree one = found_again(truth, 11), other = found_again(truth, 12);
    ASSERT_EQ(one.skeleton.branches.size(), other.skeleton.branches.size());
    ASSERT_EQ(one.leaves.size(), other.leaves.size());
    for (std::size_t b = 0; b < one.skeleton.branches.size(); ++b) {
        const Branch &a = one.skeleton.branches[b], &c = other.skeleton.branches[b];
        EXPECT_EQ(a.parent, c.parent) << b;
        ASSERT_EQ(a.nodes.size(), c.nodes.size()) << b;
        for (std::size_t n = 0; n < a.nodes.size(); ++n)
            EXPECT_LT(glm::distance(a.nodes[n].position, c.nodes[n].position), 1e-5f) << b;
    }
}

TEST(FoundBranching, TheMeasureSeesWrongGenerations) {
    const Tree truth = grown_with("oak", 1000, {});
    Tree found = found_again(truth, 1);
    EXPECT_EQ(compare_generations(truth, found).alone, compare_generations(truth, found).bearing)
        << "each branch is found as one branch of its own";
    for (Leaf& leaf : found.leaves) // all leaves on the trunk
        leaf.branch = 0;
    EXPECT_LT(compare_generations(truth, found).share(), 0.2);
}

} // namespace
} // namespace kokage

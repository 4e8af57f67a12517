// Trees of few leaves look like young trees: they stand, are taller than wide, and grow with their leaves.
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"
#include "trees/growth/leaf_shape.h"
#include "trees/growth/young_tree.h"
#include "trees/species.h"

#include <gtest/gtest.h>
#include <map>

namespace kokage {
namespace {

Tree grown(const Species& species, int leaves, std::uint64_t seed) {
    GrowthParameters p = species.parameters;
    p.leaves = leaves;
    p.seed = seed;
    return grow(p);
}

struct Bounds {
    int leaves;
    double lowest_m, highest_m; ///< how high such a seedling or sapling stands, from aspens to spruces: our own bounds
    double least_ratio;         ///< height over width
    double least_leader;        ///< where the stem ends, of the wood's height
};

constexpr Bounds bounds[] = {{1, 0.05, 0.4, 0.85, 0.85},
                             {10, 0.2, 0.8, 1.2, 0.85},
                             {50, 0.3, 1.2, 1.2, 0.85},
                             {100, 0.4, 1.5, 1.1, 0.85},
                             {800, 0.8, 3.0, 0.85, 0.4}};

TEST(YoungTrees, OfAllSpeciesStandUprightAndAreAsHighAsTheirLeavesAsk) {
    for (const Species& species : all_species()) {
        std::map<int, double> mean_height;
        for (const std::uint64_t seed : {1, 2, 3}) {
            double height_before = 0;
            for (const Bounds& bound : bounds) {
                const Tree tree = grown(species, bound.leaves, seed);
                const std::string what =
                    species.name + ", " + std::to_string(bound.leaves) + " leaves, seed " + std::to_string(seed);
                const CrownShape crown = measure_crown(tree);
                double wood_top = 0, mean_leaf_height = 0;
                for (const Branch& branch : tree.skeleton.branches)
                    for (const Branch::Node& node : branch.nodes)
                        wood_top = std::max(wood_top, double(node.position.y));
                for (const Leaf& leaf : tree.leaves)
                    mean_leaf_height += leaf.centre.y / double(tree.leaves.size());
                const double height = std::max(wood_top, crown.height);
                EXPECT_GT(height, bound.lowest_m) << what;
                EXPECT_LT(height, bound.highest_m) << what;
                EXPECT_GT(height, 0.95 * height_before) << what << ": more leaves, a higher tree";
                EXPECT_GT(height, bound.least_ratio * crown.width) << what;
                EXPECT_GT(mean_leaf_height, (bound.leaves == 1 ? 0.25 : 0.33) * height) << what;
                height_before = height;

                const auto& stem = tree.skeleton.branches[0].nodes;
                EXPECT_GE(stem.back().position.y, bound.least_leader * wood_top) << what;
                if (bound.leaves <= 100) { // later a stem may dissolve in limbs
                    EXPECT_LT(std::hypot(stem.back().position.x, stem.back().position.z), 0.2 * wood_top) << what;
                }
                mean_height[bound.leaves] += height / 3;
                for (std::size_t i = 1; i < stem.size() && bound.leaves <= 100; ++i) {
                    const glm::vec3 step = stem[i].position - stem[i - 1].position;
                    EXPECT_GT(step.y, 0.3f * glm::length(step)) << what << ", step " << i << " of the stem";
                }
            }
        }
        double before = 0;
        for (const auto& [leaves, height] : mean_height) {
            EXPECT_GT(height, 1.04 * before) << species.name << ", " << leaves << " leaves: more leaves, a higher tree";
            before = height;
        }
    }
}

TEST(YoungTrees, AreDrawnFromTheGrownTreeByDegrees) {
    GrowthParameters p = find_species("willow").parameters;
    const auto with = [&](int leaves) {
        p.leaves = leaves;
        return at_its_age(p);
    };
    EXPECT_EQ(youth(with(3000)), 0);
    EXPECT_EQ(with(3000).trunk_reach, p.trunk_reach) << "a grown tree is as its parameters say";
    EXPECT_EQ(youth(with(50)), 1);
    EXPECT_EQ(youth(with(1)), 1);
    double reach = p.trunk_reach, hang = p.shoot_hang;
    for (const int leaves : {2500, 1000, 300, 60}) {
        EXPECT_GT(with(leaves).trunk_reach, reach) << leaves;
        EXPECT_LT(with(leaves).shoot_hang, hang) << leaves;
        reach = with(leaves).trunk_reach;
        hang = with(leaves).shoot_hang;
    }
    p.young_below = 0;
    EXPECT_EQ(youth(with(1)), 0);
    p.young_below = 1;
    EXPECT_EQ(youth(with(1)), 0);
    p.young_below = 30;
    EXPECT_GT(youth(with(1)), 0.9);
    p.young_below = 2000000;
    EXPECT_GT(youth(with(1999999)), 0);
    EXPECT_LT(youth(with(1999999)), 0.01);
}

// In winter the same wood stands, with fine twigs on it that leaves would hide.
TEST(BareTrees, HaveTheWoodOfSummerAndFineTwigsOnIt) {
    for (const Species& species : all_species()) {
        GrowthParameters p = species.parameters;
        p.leaves = 6000;
        const Skeleton summer = grow(p).skeleton;
        p.season = Season::winter;
        const Skeleton winter = grow(p).skeleton;
        if (has_needles(p.leaf_shape)) {
            EXPECT_EQ(winter.branches.size(), summer.branches.size()) << species.name;
            continue;
        }
        ASSERT_GT(winter.branches.size(), 2 * summer.branches.size()) << species.name;
        for (std::size_t i = 0; i < summer.branches.size(); ++i) {
            ASSERT_EQ(winter.branches[i].nodes.size(), summer.branches[i].nodes.size()) << species.name;
            for (std::size_t n = 0; n < summer.branches[i].nodes.size(); ++n)
                ASSERT_EQ(winter.branches[i].nodes[n].position, summer.branches[i].nodes[n].position) << species.name;
        }
        for (std::size_t i = summer.branches.size(); i < winter.branches.size(); ++i) {
            const Branch& twig = winter.branches[i];
            ASSERT_EQ(twig.order, winter.branches[std::size_t(twig.parent)].order + 1);
            for (const Branch::Node& node : twig.nodes) {
                ASSERT_LE(node.radius_m, 0.51f * float(p.shoot_radius)) << species.name;
                ASSERT_GE(node.position.y, -1e-6f) << species.name;
            }
        }
        p.bare_twigs = 0;
        EXPECT_LT(grow(p).skeleton.branches.size(), winter.branches.size() / 2) << species.name;
    }
}

// Wood that turns back on itself gives nodes at one place, whose steps have no direction.
TEST(Skeleton, HasNoCoincidentNodesAndHardlyAHairpin) {
    for (const Species& species : all_species())
        for (const int leaves : {1, 60, 800, 6000, species.parameters.leaves})
            for (const std::uint64_t seed : {1, 2}) {
                const Tree tree = grown(species, leaves, seed);
                std::size_t nodes = 0, hairpins = 0;
                for (const Branch& branch : tree.skeleton.branches) {
                    ASSERT_GE(branch.nodes.size(), 2u);
                    for (std::size_t i = 1; i < branch.nodes.size(); ++i) {
                        const glm::vec3 before = branch.nodes[i].position - branch.nodes[i - 1].position;
                        ++nodes;
                        ASSERT_GT(glm::length(before), 0.f) << species.name << ", " << leaves << ", " << seed;
                        if (i + 1 == branch.nodes.size())
                            continue;
                        const glm::vec3 after = branch.nodes[i + 1].position - branch.nodes[i].position;
                        hairpins += glm::dot(before, after) < -0.17f * glm::length(before) * glm::length(after);
                    }
                }
                EXPECT_LE(hairpins * 10000, nodes) << species.name << ", " << leaves << ", " << seed;
            }
}

} // namespace
} // namespace kokage

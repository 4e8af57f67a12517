// Each species' shape against what is described of it.
//
// Height over crown width: from the ranges of height and spread that these give, lowest height over widest spread to
// highest over narrowest, in feet. Oak 50-60 x 50-60, beech 50-60 x 35-50, spruce 40-60 x 25-30, pine 30-60 x 30-40,
// maple 40-50 x 30-50: Dirr 2009, Manual of Woody Landscape Plants. Birch 40-50 x 25-30 (12-15 m x 7.5-9 m): Brickell
// 2003, RHS A-Z Encyclopedia of Garden Plants. Willow 30-50 x 30-50, cherry 20-30 x 20-30, cypress 40-60 x 3-6:
// Missouri Botanical Garden, Plant Finder. Aspen 70-90 x up to 30: University of Alaska, Alaska plant materials.
// Branching angles: spruce 40 to 70 degrees (Fabrika et al. 2019, BioResources 14(1) 908); for the others what their
// files ask for.
#include "tests/unit/trees/growth_shape.h"
#include "trees/growth.h"

#include <gtest/gtest.h>
#include <map>
#include <tuple>

namespace kokage {
namespace {

struct Described {
    const char* species;
    double lowest_ratio, highest_ratio;           ///< height over width
    double lowest_crown_base, highest_crown_base; ///< where the lowest twentieth of the leaves ends, of the height
    double smallest_angle, largest_angle;         ///< mean between branches and the axes that bear them, in degrees
    bool has_leader;                              ///< the trunk reaches the top
};

const std::vector<Described> described = {
    {"oak", 50.0 / 60, 60.0 / 50, 0.1, 0.4, 35, 70, false},
    {"beech", 50.0 / 50, 60.0 / 35, 0.1, 0.35, 30, 65, false},
    {"birch", 40.0 / 30, 50.0 / 25, 0.05, 0.4, 30, 70, true},
    {"maple", 40.0 / 50, 50.0 / 30, 0.1, 0.4, 30, 65, false},
    {"willow", 30.0 / 50, 50.0 / 30, 0.0, 0.25, 30, 70, false},
    {"aspen", 70.0 / 30, 4.0, 0.3, 0.6, 30, 70, true},
    {"pine", 30.0 / 40, 60.0 / 30, 0.45, 0.8, 30, 75, true},
    {"spruce", 40.0 / 30, 60.0 / 25, 0.0, 0.12, 40, 70, true},
    {"cypress", 40.0 / 6, 60.0 / 3, 0.0, 0.12, 10, 45, true},
    {"cherry", 20.0 / 30, 30.0 / 20, 0.2, 0.55, 25, 60, false},
};

/// Mean angle between branches that bear others, or are long, and their parents where they leave them.
double mean_branching_angle(const Tree& tree) {
    double sum = 0;
    int count = 0;
    for (const Branch& branch : tree.skeleton.branches) {
        if (branch.parent < 0 || branch.order < 2 || branch.nodes.size() < 6)
            continue;
        const auto& parent = tree.skeleton.branches[std::size_t(branch.parent)].nodes;
        std::size_t at = 0;
        while (at + 1 < parent.size() && parent[at].position != branch.nodes[0].position)
            ++at;
        if (at == 0 || at + 1 >= parent.size())
            continue;
        const glm::vec3 axis = parent[at + 1].position - parent[at - 1].position,
                        out = branch.nodes[2].position - branch.nodes[0].position;
        const float lengths = glm::length(axis) * glm::length(out);
        if (!(lengths > 0)) // a step back to where the one before began
            continue;
        sum += std::acos(std::clamp(glm::dot(axis, out) / lengths, -1.f, 1.f)) * 180 / kPi;
        ++count;
    }
    return count ? sum / count : 0;
}

double crown_base(const Tree& tree, double height) {
    std::vector<float> heights;
    for (const Leaf& leaf : tree.leaves)
        heights.push_back(leaf.centre.y);
    std::nth_element(heights.begin(), heights.begin() + std::ptrdiff_t(heights.size() / 20), heights.end());
    return heights[heights.size() / 20] / height;
}

TEST(SpeciesShape, IsAsDescribed) {
    ASSERT_EQ(described.size(), all_species().size());
    for (const Described& d : described)
        for (const std::uint64_t seed : {1, 2, 3}) {
            GrowthParameters p = find_species(d.species).parameters;
            p.seed = seed;
            const Tree tree = grow(p);
            const CrownShape crown = measure_crown(tree);
            const std::string what = std::string(d.species) + ", seed " + std::to_string(seed);
            EXPECT_GT(crown.height / crown.width, d.lowest_ratio) << what;
            EXPECT_LT(crown.height / crown.width, d.highest_ratio) << what;
            const double base = crown_base(tree, crown.height);
            EXPECT_GE(base, d.lowest_crown_base) << what;
            EXPECT_LE(base, d.highest_crown_base) << what;
            const double angle = mean_branching_angle(tree);
            EXPECT_GT(angle, d.smallest_angle) << what;
            EXPECT_LT(angle, d.largest_angle) << what;
            const std::vector<Branch>& branches = tree.skeleton.branches;
            float thickest_limb = 0;
            for (const Branch& branch : branches)
                if (branch.order == 1)
                    thickest_limb = std::max(thickest_limb, branch.nodes[0].radius_m);
            const float limb_share = thickest_limb / branches[0].nodes[0].radius_m,
                        top_share = branches[0].nodes.back().position.y / float(crown.height);
            if (d.has_leader) {
                EXPECT_GT(top_share, 0.88) << what;
                EXPECT_LT(limb_share, 0.47) << what;
            } else {
                EXPECT_GT(limb_share, 0.27) << what << ": heavy limbs";
            }
            // Crown over stem: 24 to 27 in free-standing oak, birch and maple (Coombes et al. 2019, Urban Forestry &
            // Urban Greening 44); down to 13 in old ones and others (Hemery et al. 2005, Forest Ecology and Management
            // 215), half of that in a column.
            const double stem_ratio = crown.width / (2 * branches[0].nodes[0].radius_m);
            EXPECT_GT(stem_ratio, d.lowest_ratio > 6 ? 7 : 13) << what;
            EXPECT_LT(stem_ratio, 34) << what;
        }
}

// Branch arrangement follows the leaves': a two-ranked beech's branches lie flatter than a spirally set oak's would,
// and a maple's leave their axes in pairs.
TEST(SpeciesShape, BranchesStandAsLeavesDo) {
    const auto share_of_pairs = [](LeafArrangement arrangement) {
        GrowthParameters p = find_species("maple").parameters;
        p.leaf_arrangement = arrangement;
        p.leaves = 8000;
        const Tree tree = grow(p);
        std::map<std::tuple<std::int32_t, float, float, float>, int> feet;
        for (const Branch& branch : tree.skeleton.branches)
            if (branch.order >= 2 && branch.nodes.size() > 3) {
                const glm::vec3 foot = branch.nodes[0].position;
                ++feet[{branch.parent, foot.x, foot.y, foot.z}];
            }
        int pairs = 0, all = 0;
        for (const auto& [foot, count] : feet) {
            pairs += count == 2;
            ++all;
        }
        return double(pairs) / all;
    };
    EXPECT_GT(share_of_pairs(LeafArrangement::opposite), 2 * share_of_pairs(LeafArrangement::spiral));

    const auto mean_flatness = [](LeafArrangement arrangement) { // of branches on level ones
        GrowthParameters p = find_species("beech").parameters;
        p.leaf_arrangement = arrangement;
        p.leaves = 8000;
        const Tree tree = grow(p);
        double sum = 0;
        int count = 0;
        for (const Branch& branch : tree.skeleton.branches)
            if (branch.order >= 2 && branch.nodes.size() > 2) {
                const glm::vec3 out = glm::normalize(branch.nodes[1].position - branch.nodes[0].position);
                sum += std::abs(out.y);
                ++count;
            }
        return sum / count;
    };
    EXPECT_LT(mean_flatness(LeafArrangement::distichous), mean_flatness(LeafArrangement::spiral));
}

TEST(SpeciesShape, WeepingTwigsHangToTheGroundAndNotBelow) {
    const Tree tree = grow(find_species("willow").parameters);
    const CrownShape crown = measure_crown(tree);
    std::size_t hanging = 0, long_ones = 0;
    for (const Branch& branch : tree.skeleton.branches) {
        for (const Branch::Node& node : branch.nodes)
            ASSERT_GE(node.position.y, 0.f);
        const glm::vec3 way = branch.nodes.back().position - branch.nodes.front().position;
        if (branch.nodes.size() >= 7 && glm::length(way) > 0.1f * float(crown.height)) {
            ++long_ones;
            hanging += way.y < -0.5f * glm::length(way);
        }
    }
    EXPECT_GT(long_ones, 300u);
    EXPECT_GT(hanging, long_ones * 8 / 10);
    EXPECT_LT(crown.lowest_leaf, 0.1 * crown.height);
}

} // namespace
} // namespace kokage

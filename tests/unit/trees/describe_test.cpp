#include "trees/describe.h"

#include "tests/support/tree_files.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

/// A 2 x 1 m and a 1 x 1 m leaf on a branch of order 1, and a wooden triangle of 0.5 m2.
Tree described_tree() {
    Tree tree;
    tree.name = "small";
    tree.source = "by hand";
    tree.origin = {100, 10, 0};
    tree.branching_known = false;
    tree.notes = {"a note"};
    tree.materials.resize(2);
    tree.materials[0].name = "wood";
    tree.materials[0].base_color = {0.15f, 0.1f, 0.07f};
    tree.materials[1].name = "green";
    tree.materials[1].base_color = {0.2f, 0.4f, 0.1f};
    TreePart wood, foliage;
    wood.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    wood.normals.assign(3, {0, 0, 1});
    wood.triangles = {{0, 1, 2}};
    wood.triangle_patch = {0};
    foliage.kind = TreePartKind::foliage;
    foliage.material = 1;
    foliage.positions = {{0, 3, 5}, {1, 3, 5}, {1, 4, 5}, {0, 4, 5}, {0, 3, 3}, {2, 3, 3}, {2, 4, 3}, {0, 4, 3}};
    foliage.normals.assign(8, {0, 0, 1});
    foliage.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    foliage.triangle_patch = {0, 0, 1, 1};
    tree.parts = {wood, foliage};
    tree.skeleton.branches.resize(3);
    tree.skeleton.branches[1].parent = tree.skeleton.branches[2].parent = 0;
    tree.skeleton.branches[1].order = tree.skeleton.branches[2].order = 1;
    for (Branch& branch : tree.skeleton.branches)
        branch.nodes.push_back({{0, 0, 0}, 0.1f});
    tree.leaves = {{{0.5f, 3.5f, 5}, 2}, {{1, 3.5f, 3}, 2}};
    tree.bark_patch_count = 1;
    return tree;
}

TEST(TreeDescription, CountsAndMeasures) {
    const TreeDescription d = describe(described_tree());
    EXPECT_EQ(d.leaves, 2u);
    EXPECT_EQ(d.bark_patches, 1u);
    EXPECT_EQ(d.triangles, 5u);
    EXPECT_NEAR(d.leaf_area_m2, 3.0, 1e-6);
    EXPECT_NEAR(d.smallest_leaf_m2, 1.0, 1e-6);
    EXPECT_NEAR(d.largest_leaf_m2, 2.0, 1e-6);
    EXPECT_NEAR(d.bark_area_m2, 0.5, 1e-6);
    EXPECT_EQ(d.low, glm::dvec3(100, 10, 0));
    EXPECT_EQ(d.high, glm::dvec3(102, 14, 5));
    EXPECT_NEAR(d.crown_radius_m, 1.0, 1e-6);
    ASSERT_EQ(d.orders.size(), 2u);
    EXPECT_EQ(d.orders.at(1).branches, 2u);
    EXPECT_EQ(d.orders.at(1).bearing, 1u);
    EXPECT_EQ(d.orders.at(1).leaves, 2u);
    ASSERT_EQ(d.surfaces.size(), 2u);
    EXPECT_TRUE(d.surfaces[1].transmittance_guessed);
    EXPECT_NEAR(d.surfaces[1].optics.reflectance.g, 0.4f, 1e-6f);
    EXPECT_NEAR(d.surfaces[1].optics.transmittance.g, 0.32f, 1e-6f);
}

TEST(TreeDescription, TextAndJsonTellTheSame) {
    const TreeDescription d = describe(described_tree());
    const std::string text = text_of(d);
    for (const char* part : {"small (by hand)", "4 m high", "leaves       2, 3 m2 together", "inferred",
                             "order 1    2 branches, 2 leaves on 1", "'green': 4 triangles",
                             "transmittance 0.160, 0.320, 0.080 (guessed)", "note         a note"})
        EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
    const nlohmann::json json = json_of(d);
    EXPECT_EQ(json["leaves"]["count"], 2);
    EXPECT_EQ(json["height_m"], 4.0);
    EXPECT_EQ(json["branching"]["orders"][1]["bearing"], 1);
    EXPECT_EQ(json["surfaces"][1]["reflectance"][1], 0.4);
    EXPECT_EQ(json["notes"][0], "a note");
    EXPECT_EQ(nlohmann::json::parse(json.dump()), json);
}

TEST(TreeDescription, NamesOfFilesReachTheTerminalWithoutControls) {
    Tree tree = described_tree();
    tree.name = "a\x1b]0;title\x07";
    tree.materials[1].name = "\xc2\x9b[2J" + std::string(77, 'x') + "\xc3\xa4" + std::string(5000, 'y');
    tree.notes = {"two\nlines"};
    const std::string text = text_of(describe(tree));
    EXPECT_NE(text.find("tree         a?]0;title? (by hand)"), std::string::npos) << text;
    EXPECT_NE(text.find("note         two?lines\n"), std::string::npos) << text;
    EXPECT_EQ(text.find("yyy"), std::string::npos) << text;
    EXPECT_EQ(text.find("\xc2\x9b"), std::string::npos) << text;
}

} // namespace
} // namespace kokage

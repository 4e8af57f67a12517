// Finding foliage, leaves and branching in files that are not ours.
#include "trees/read_tree.h"

#include "common/services/error.h"
#include "tests/support/gltf_text.h"
#include "tests/support/program_run.h"
#include "tests/support/tree_files.h"
#include "trees/bark_skeleton.h"
#include "trees/part_names.h"
#include "trees/patches.h"
#include "trees/surface_patches.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tuple>

namespace kokage {
namespace {

/// Quads of side `size` around centres, all facing +Z: two triangles each.
struct Cards {
    std::vector<float> positions;
    std::vector<std::uint16_t> indices;
    void add(const glm::vec3& centre, float size) {
        const auto first = std::uint16_t(positions.size() / 3);
        for (const auto& [x, y] : {std::pair{-0.5f, -0.5f}, {0.5f, -0.5f}, {0.5f, 0.5f}, {-0.5f, 0.5f}})
            positions.insert(positions.end(), {centre.x + size * x, centre.y + size * y, centre.z});
        for (const int corner : {0, 1, 2, 0, 2, 3})
            indices.push_back(std::uint16_t(first + corner));
    }
};

/// An open tube along straight pieces, as exporters make branches: rings of `sides` vertices.
void add_tube(std::vector<float>& positions, std::vector<std::uint16_t>& indices, const std::vector<glm::vec4>& axis,
              int sides = 6) {
    const auto first = int(positions.size() / 3);
    const glm::vec3 along = glm::normalize(glm::vec3(axis.back()) - glm::vec3(axis.front()));
    const glm::vec3 a =
        glm::normalize(glm::cross(along, std::abs(along.y) > 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0)));
    const glm::vec3 b = glm::cross(along, a);
    for (const glm::vec4& node : axis)
        for (int s = 0; s < sides; ++s) {
            const float angle = 2 * kPi * float(s) / float(sides);
            const glm::vec3 p = glm::vec3(node) + node.w * (std::cos(angle) * a + std::sin(angle) * b);
            positions.insert(positions.end(), {p.x, p.y, p.z});
        }
    for (int ring = 0; ring + 1 < int(axis.size()); ++ring)
        for (int s = 0; s < sides; ++s) {
            const int i = first + ring * sides + s, j = first + ring * sides + (s + 1) % sides;
            for (const int corner : {i, j, j + sides, i, j + sides, i + sides})
                indices.push_back(std::uint16_t(corner));
        }
}

/// A trunk of 4 m with two boughs, each with a bough of its own, and leaves at the tips.
GltfText small_tree_file() {
    GltfText file;
    std::vector<float> wood;
    std::vector<std::uint16_t> wood_indices;
    add_tube(wood, wood_indices,
             {{0, 0, 0, 0.2f}, {0, 1, 0, 0.18f}, {0, 2, 0, 0.16f}, {0, 3, 0, 0.12f}, {0, 4, 0, 0.05f}});
    add_tube(wood, wood_indices, {{0, 2, 0, 0.1f}, {1, 2.5f, 0, 0.08f}, {2, 3, 0, 0.03f}});
    add_tube(wood, wood_indices, {{0, 3, 0, 0.08f}, {-1, 3.5f, 0, 0.06f}, {-2, 4, 0, 0.02f}});
    add_tube(wood, wood_indices, {{1, 2.5f, 0, 0.04f}, {1, 3, 1, 0.03f}, {1, 3.5f, 2, 0.01f}});
    Cards leaves;
    for (const glm::vec3& tip : {glm::vec3(0, 4, 0), {2, 3, 0}, {-2, 4, 0}, {1, 3.5f, 2}})
        for (int i = 0; i < 5; ++i)
            leaves.add(tip + glm::vec3(0.05f * float(i), 0.1f, 0.02f * float(i)), 0.08f);
    const int wood_positions = file.positions(wood), wood_index = file.indices(wood_indices);
    const int leaf_positions = file.positions(leaves.positions), leaf_index = file.indices(leaves.indices);
    file.mesh({{"attributes", {{"POSITION", wood_positions}}}, {"indices", wood_index}, {"material", 0}}, "mesh A");
    file.mesh({{"attributes", {{"POSITION", leaf_positions}}}, {"indices", leaf_index}, {"material", 1}}, "mesh B");
    file.json["materials"] = {
        {{"name", "bark"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.2, 0.1, 0.05, 1}}}}},
        {{"name", "leaves"}, {"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.3, 0.05, 1}}}}}};
    file.node({{"mesh", 0}});
    file.node({{"mesh", 1}});
    file.scene({0, 1});
    return file;
}

Tree load(const GltfText& file, const ReadOptions& options = {}) {
    TemporaryFolder folder;
    file.write(folder / "tree.gltf");
    return read_tree(folder / "tree.gltf", options);
}

TEST(ForeignTree, FindsTheBranchingOfTubes) {
    const Tree tree = load(small_tree_file());
    EXPECT_FALSE(tree.branching_known);
    ASSERT_EQ(tree.leaves.size(), 20u);
    ASSERT_EQ(tree.skeleton.branches.size(), 4u);
    std::vector<int> orders;
    for (const Branch& branch : tree.skeleton.branches)
        orders.push_back(branch.order);
    std::sort(orders.begin(), orders.end());
    EXPECT_EQ(orders, (std::vector<int>{0, 1, 1, 2}));
    for (const Branch& branch : tree.skeleton.branches) {
        if (branch.order == 0) {
            EXPECT_LT(glm::distance(branch.nodes[0].position, glm::vec3(0, 0, 0)), 0.2f);
            EXPECT_LT(glm::distance(branch.nodes.back().position, glm::vec3(0, 4, 0)), 0.1f);
            EXPECT_NEAR(branch.nodes[0].radius_m, 0.2f, 0.03f);
        }
        if (branch.order == 2) { // leaves its parent where its tube begins
            EXPECT_LT(glm::distance(branch.nodes[0].position, glm::vec3(1, 2.5f, 0)), 0.1f);
            EXPECT_LT(glm::distance(branch.nodes.back().position, glm::vec3(1, 3.5f, 2)), 0.1f);
        }
        EXPECT_EQ(branch.order, branch.parent < 0 ? 0 : tree.skeleton.branches[std::size_t(branch.parent)].order + 1);
    }
    for (std::size_t i = 0; i < 20; ++i) { // each leaf hangs on the branch whose tip it is at
        const Branch& bearer = tree.skeleton.branches[std::size_t(tree.leaves[i].branch)];
        EXPECT_LT(glm::distance(bearer.nodes.back().position, tree.leaves[i].centre), 0.4f) << "leaf " << i;
    }
    EXPECT_GT(tree.bark_patch_count, 8u);
    validate(make_patches(tree));
}

TEST(ForeignTree, FoliageIsFoundByEachRuleInTurn) {
    const auto kinds = [](const GltfText& file, const ReadOptions& options = {}) {
        const Tree tree = load(file, options);
        std::size_t leaf_triangles = 0;
        for (const TreePart& part : tree.parts)
            if (part.kind == TreePartKind::foliage)
                leaf_triangles += part.triangles.size();
        return leaf_triangles;
    };
    GltfText file = small_tree_file();
    auto& materials = file.json["materials"];
    EXPECT_EQ(kinds(file), 40u) << "by the name 'leaves'";
    materials[0]["name"] = "a";
    materials[1]["name"] = "b";
    EXPECT_EQ(kinds(file), 40u) << "by its green";
    materials[1]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 0.2, 0.1, 1};
    EXPECT_EQ(kinds(file), 0u) << "nothing speaks of leaves";
    file.json["nodes"][1]["name"] = "Foliage_02";
    EXPECT_EQ(kinds(file), 40u) << "by the name of its node";
    file.json["nodes"][1].erase("name");
    materials[1]["alphaMode"] = "MASK";
    EXPECT_EQ(kinds(file), 40u) << "by its mask";
    materials[1].erase("alphaMode");
    materials[1]["extensions"]["KHR_materials_diffuse_transmission"] = {{"diffuseTransmissionFactor", 0.5}};
    EXPECT_EQ(kinds(file), 40u) << "by its transmission";
    materials[1].erase("extensions");
    EXPECT_EQ(kinds(file, {.foliage_materials = {"B"}}), 40u) << "as the user says";
    EXPECT_EQ(kinds(file, {.foliage_materials = {"mesh B"}}), 40u) << "as the user says, by mesh";
    try {
        load(file, {.foliage_materials = {"laeves"}});
        FAIL() << "a name that fits nothing was passed over";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("'a', 'b'"), std::string::npos) << error.what();
    }
}

TEST(ForeignTree, NamesAreJudged) {
    for (const char* name :
         {"leaves_oak", "Needles", "DarkGreen", "Birch_Leaves", "leafsFall", "Foliage.001", "cherry blossom"})
        EXPECT_TRUE(names_foliage(name)) << name;
    for (const char* name : {"bark_oak", "Wood", "woodBirch", "Trunk", "Material", "branches"})
        EXPECT_FALSE(names_foliage(name)) << name;
    for (const char* name : {"bark_oak", "Wood", "woodBirch", "Trunk", "branches"})
        EXPECT_TRUE(names_wood(name)) << name;
}

TEST(ForeignTree, OneMaterialWithVertexColorsIsCutByColor) {
    // Leaves and bark in one mesh and one nameless material, told apart by their vertex colours alone.
    GltfText file = small_tree_file();
    Cards leaves;
    for (int i = 0; i < 5; ++i)
        leaves.add({0.4f * float(i), 4, 0}, 0.3f);
    std::vector<std::uint16_t> indices;
    const auto leaf_vertices = std::uint16_t(leaves.positions.size() / 3);
    add_tube(leaves.positions, indices, {{0, 0, 0, 0.2f}, {0, 2, 0, 0.15f}, {0, 4, 0, 0.1f}});
    indices.insert(indices.end(), leaves.indices.begin(), leaves.indices.end());
    std::vector<float> colors;
    for (std::size_t v = 0; v < leaves.positions.size() / 3; ++v) {
        const glm::vec3 color = v < leaf_vertices ? glm::vec3(0.1f, 0.4f, 0.05f) : glm::vec3(0.3f, 0.2f, 0.1f);
        colors.insert(colors.end(), {color.r, color.g, color.b});
    }
    file.json["meshes"] = nlohmann::json::array();
    file.json["materials"] = {{{"name", "m"}}};
    const int position = file.positions(leaves.positions), color = file.normals(colors), index = file.indices(indices);
    file.mesh({{"attributes", {{"POSITION", position}, {"COLOR_0", color}}}, {"indices", index}, {"material", 0}},
              "all");
    file.json["nodes"] = {{{"mesh", 0}}};
    file.json["scenes"] = {{{"nodes", {0}}}};
    const Tree tree = load(file);
    EXPECT_EQ(tree.leaves.size(), 5u);
    ASSERT_EQ(tree.parts.size(), 2u);
    for (const TreePart& part : tree.parts) {
        const bool leaf = part.kind == TreePartKind::foliage;
        EXPECT_EQ(part.triangles.size(), leaf ? 10u : 24u);
        EXPECT_NEAR(tree.materials[part.material].base_color.g, leaf ? 0.4f : 0.2f, 1e-5f)
            << "each part has its own mean colour";
    }
}

TEST(ForeignTree, BranchingDoesNotDependOnSize) {
    GltfText file = small_tree_file();
    for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
        const Tree tree = load(file, {.scale = scale});
        EXPECT_EQ(tree.skeleton.branches.size(), 4u) << scale;
        EXPECT_EQ(tree.leaves.size(), 20u) << scale;
        EXPECT_TRUE(std::isfinite(tree.leaves[7].centre.y)) << scale;
    }
}

TEST(ForeignTree, DoubledSheetsBecomeOneLeaf) {
    GltfText file = small_tree_file();
    // The same cards again from behind, as exporters do for viewers that cull back faces.
    auto& primitive = file.json["meshes"][1]["primitives"][0];
    Cards leaves;
    leaves.add({0, 4, 0}, 0.1f);
    leaves.add({1, 4, 0}, 0.1f);
    std::vector<std::uint16_t> both = leaves.indices;
    for (std::size_t i = 0; i < leaves.indices.size(); i += 3)
        both.insert(both.end(), {leaves.indices[i], leaves.indices[i + 2], leaves.indices[i + 1]});
    primitive["attributes"]["POSITION"] = file.positions(leaves.positions);
    primitive["indices"] = file.indices(both);
    const Tree tree = load(file);
    EXPECT_EQ(tree.leaves.size(), 2u);
}

TEST(ForeignTree, ZIsUpWhereTheUserSaysSo) {
    GltfText file = small_tree_file();
    const Tree upright = load(file), turned = load(file, {.z_is_up = true});
    ASSERT_EQ(upright.leaves.size(), turned.leaves.size());
    for (std::size_t i = 0; i < upright.leaves.size(); ++i) {
        const glm::vec3 &a = upright.leaves[i].centre, &b = turned.leaves[i].centre;
        EXPECT_NEAR(glm::distance(glm::vec3(a.x, a.z, -a.y), b), 0, 1e-5f) << i;
    }
}

TEST(ForeignTree, LeafSizeAndScaleAreTaken) {
    GltfText file = small_tree_file();
    const Tree metres = load(file), centimetres = load(file, {.scale = 0.01});
    ASSERT_EQ(metres.leaves.size(), centimetres.leaves.size());
    EXPECT_NEAR(centimetres.leaves[3].centre.y, 0.01f * metres.leaves[3].centre.y, 1e-6f);
    EXPECT_EQ(metres.skeleton.branches.size(), centimetres.skeleton.branches.size());
    EXPECT_THROW(load(file, {.scale = 0}), InputError);
    EXPECT_THROW(load(file, {.leaf_size = -1}), InputError);
    const auto warns = [&](float size) {
        const Tree tree = load(file, {.leaf_size = size});
        return std::any_of(tree.notes.begin(), tree.notes.end(), [](const std::string& note) {
            return note.find("less than a thousandth of the crown's radius") != std::string::npos;
        });
    };
    EXPECT_TRUE(warns(1e-9f));
    EXPECT_FALSE(warns(0.1f));
}

TEST(SurfacePatches, CutWhereTheSurfaceTurnsOrGrows) {
    // A strip of ten unit squares along x, bent by 40 degrees after the fifth.
    std::vector<glm::vec3> positions;
    std::vector<glm::uvec3> triangles;
    glm::vec3 at(0.f), step(1, 0, 0);
    for (int i = 0; i <= 10; ++i) {
        positions.push_back(at);
        positions.push_back(at + glm::vec3(0, 0, 1));
        if (i == 5)
            step = {std::cos(0.698f), std::sin(0.698f), 0};
        at += step;
        if (i < 10) {
            const auto v = std::uint32_t(2 * i);
            triangles.emplace_back(v, v + 1, v + 2);
            triangles.emplace_back(v + 2, v + 1, v + 3);
        }
    }
    SurfacePatchLimits limits;
    limits.max_radius = [](const glm::vec3&) { return 100.f; };
    std::vector<std::uint32_t> patch = surface_patches(positions, triangles, limits);
    EXPECT_EQ(*std::max_element(patch.begin(), patch.end()), 1u) << "one bend, two patches";
    EXPECT_EQ(patch[9], 0u);
    EXPECT_EQ(patch[10], 1u);
    limits.max_radius = [](const glm::vec3&) { return std::sqrt(2.f / kPi); }; // two squares
    patch = surface_patches(positions, triangles, limits);
    const std::uint32_t count = *std::max_element(patch.begin(), patch.end()) + 1;
    EXPECT_GE(count, 6u);
    EXPECT_LE(count, 8u);
    std::vector<int> sizes(count, 0);
    for (const std::uint32_t p : patch)
        ++sizes[p];
    EXPECT_LE(*std::max_element(sizes.begin(), sizes.end()), 4);
}

TEST(ForeignTree, EveryRealTreeLoads) {
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    struct Expectation {
        const char* file;
        std::size_t leaves, tolerance;
    };
    // ez-tree's leaves are single cards: half as many as triangles. The others are what our rule cuts.
    for (const Expectation& e : {Expectation{"eztree_oak_medium.glb", 5320, 0},
                                 {"eztree_ash_large.glb", 4840, 0},
                                 {"eztree_bush_1.glb", 2496, 0},
                                 {"quaternius_common_tree_1.glb", 500, 400},
                                 {"quaternius_willow_2.glb", 800, 400},
                                 {"quaternius_pine_3.glb", 1500, 800},
                                 {"quaternius_tex_birch_8.glb", 1000, 600},
                                 {"quaternius_tex_pine_1.glb", 500, 300},
                                 {"kenney_tree_oak_fall.glb", 64, 0}}) {
        const Tree tree = read_tree(*data / "trees" / e.file);
        EXPECT_NEAR(double(tree.leaves.size()), double(e.leaves), double(e.tolerance)) << e.file;
        EXPECT_GT(tree.bark_patch_count, 0u) << e.file;
        const PatchScene scene = make_patches(tree);
        validate(scene);
        EXPECT_EQ(scene.patches.size(), tree.leaves.size() + tree.bark_patch_count) << e.file;
        // Branching that [F] can place maps at: generations 1 to n, every leaf on a branch, branches that hang
        // together.
        int last = 0;
        for (const Leaf& leaf : tree.leaves) {
            ASSERT_GE(leaf.branch, 0) << e.file;
            last = std::max(last, tree.skeleton.branches[std::size_t(leaf.branch)].order);
        }
        EXPECT_GE(last, 2) << e.file;
        // ez-tree's trees have three levels of branches, each a tube of its own.
        EXPECT_LE(last, std::string(e.file).starts_with("eztree") ? 5 : 8) << e.file;
        std::vector<int> of_order(std::size_t(last) + 1, 0);
        for (std::size_t b = 0; b < tree.skeleton.branches.size(); ++b) {
            const Branch& branch = tree.skeleton.branches[b];
            ASSERT_LT(branch.parent, std::int32_t(b)) << e.file;
            EXPECT_EQ(branch.order,
                      branch.parent < 0 ? 0 : tree.skeleton.branches[std::size_t(branch.parent)].order + 1)
                << e.file;
            ASSERT_FALSE(branch.nodes.empty());
            if (branch.order <= last)
                ++of_order[std::size_t(branch.order)];
        }
        for (const int count : of_order)
            EXPECT_GT(count, 0) << e.file;
    }
}

// ez-tree gives every branch of a tree the same number of leaves, and lets a branch begin on its parent's axis: what it
// knows of its trees is found again without its telling.
TEST(ForeignTree, EzTreesBranchesBearTheirLeavesAgain) {
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    for (const auto& [file, branches, leaves, recovered] : {std::tuple{"eztree_oak_medium.glb", 140u, 38u, 1.0},
                                                            {"eztree_ash_large.glb", 220u, 22u, 0.89},
                                                            {"eztree_bush_1.glb", 96u, 26u, 0.97}}) {
        const Tree tree = read_tree(*data / "trees" / file);
        ASSERT_EQ(tree.skeleton.branches.size(), branches) << file;
        std::vector<std::uint32_t> borne(branches, 0);
        for (const Leaf& leaf : tree.leaves)
            ++borne[std::size_t(leaf.branch)];
        const auto right = std::count(borne.begin(), borne.end(), leaves);
        EXPECT_GE(double(right), recovered * double(branches)) << file; // measured: 140, 197 and 94
        EXPECT_EQ(std::count_if(tree.skeleton.branches.begin(), tree.skeleton.branches.end(),
                                [](const Branch& branch) { return branch.parent < 0; }),
                  1)
            << file;
    }
}

TEST(ForeignTree, APotIsNoTrunk) {
    GltfText file = small_tree_file();
    file.json["materials"][0]["name"] = "clay pot";
    const Tree tree = load(file);
    EXPECT_GT(tree.bark_patch_count, 0u) << "it takes part in the light";
    for (const Branch& branch : tree.skeleton.branches)
        for (const Branch::Node& node : branch.nodes)
            EXPECT_EQ(node.radius_m, 0.f) << "all wood is imagined";
    file.json["materials"][0]["name"] = "bark of a potted tree";
    EXPECT_GT(load(file).skeleton.branches[0].nodes[0].radius_m, 0.f);
}

TEST(ForeignTree, StonesAreNoBranches) {
    GltfText file = small_tree_file();
    // Two cubes beside the trunk, of the trunk's material.
    std::vector<float> positions;
    std::vector<std::uint16_t> indices;
    for (const float x : {1.5f, -1.5f}) {
        const auto first = std::uint16_t(positions.size() / 3);
        for (int corner = 0; corner < 8; ++corner)
            positions.insert(positions.end(),
                             {x + 0.5f * float(corner & 1), 0.5f * float(corner >> 1 & 1), 0.5f * float(corner >> 2)});
        for (const int v : {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                            2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5})
            indices.push_back(std::uint16_t(first + v));
    }
    const Tree without = load(file);
    const int position = file.positions(positions), index = file.indices(indices);
    const int mesh =
        file.mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}, {"material", 0}}, "stones");
    file.json["scenes"][0]["nodes"].push_back(file.node({{"mesh", mesh}}));
    const Tree with = load(file);
    EXPECT_EQ(with.skeleton.branches.size(), without.skeleton.branches.size());
    EXPECT_GT(with.bark_patch_count, without.bark_patch_count) << "they take part in the light";
    EXPECT_TRUE(std::any_of(with.notes.begin(), with.notes.end(), [](const std::string& note) {
        return note.find("2 pieces of bark too stout") != std::string::npos;
    }));
}

} // namespace
} // namespace kokage

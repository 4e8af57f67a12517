#include "common/services/error.h"
#include "trees/patches.h"

#include <gtest/gtest.h>
#include <set>

namespace kokage {
namespace {

double area(const PatchScene& scene, std::uint32_t triangle) {
    const glm::uvec3 t = scene.triangles[triangle];
    return 0.5 * glm::length(glm::cross(glm::dvec3(scene.positions[t.y] - scene.positions[t.x]),
                                        glm::dvec3(scene.positions[t.z] - scene.positions[t.x])));
}

/// Two leaves of two triangles each (a 2 x 1 m and a 1 x 1 m card) and one bark triangle; leaf 1 comes first in its
/// part.
Tree small_tree() {
    Tree tree;
    tree.name = "small";
    TreeMaterial leaf, bark;
    leaf.base_color = {0.2f, 0.4f, 0.1f};
    bark.base_color = {0.15f, 0.1f, 0.07f};
    tree.materials = {bark, leaf};
    TreePart wood;
    wood.kind = TreePartKind::bark;
    wood.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    wood.normals.assign(3, {0, 0, 1});
    wood.triangles = {{0, 1, 2}};
    wood.triangle_patch = {0};
    TreePart foliage;
    foliage.kind = TreePartKind::foliage;
    foliage.material = 1;
    foliage.positions = {{0, 0, 5}, {1, 0, 5}, {1, 1, 5}, {0, 1, 5}, {0, 0, 3}, {2, 0, 3}, {2, 1, 3}, {0, 1, 3}};
    foliage.normals.assign(8, {0, 0, 1});
    foliage.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
    foliage.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
    foliage.triangle_patch = {1, 1, 0, 0};
    tree.parts = {wood, foliage};
    tree.leaves.resize(2);
    tree.bark_patch_count = 1;
    return tree;
}

TEST(Patches, LeavesComeFirstInLeafOrderThenBark) {
    const PatchScene scene = make_patches(small_tree());
    ASSERT_EQ(scene.patches.size(), 3u);
    EXPECT_EQ(scene.leaf_count, 2u);
    EXPECT_EQ(scene.patches[0].kind, PatchKind::leaf);
    EXPECT_EQ(scene.patches[0].leaf, 0u);
    EXPECT_EQ(scene.patches[1].leaf, 1u);
    EXPECT_EQ(scene.patches[2].kind, PatchKind::bark);
    EXPECT_FLOAT_EQ(scene.positions[scene.triangles[0].x].z, 3.f) << "leaf 0 is the card at z = 3";
    EXPECT_EQ(scene.triangle_patch, (std::vector<std::uint32_t>{0, 0, 1, 1, 2}));
    EXPECT_EQ(scene.uvs.size(), scene.positions.size());
    EXPECT_TRUE(scene.triangle_mask.empty());
    const Optics leaf = scene.optics[scene.patches[0].optics], bark = scene.optics[scene.patches[2].optics];
    EXPECT_FLOAT_EQ(leaf.reflectance.g, 0.4f);
    EXPECT_FLOAT_EQ(leaf.transmittance.g, 0.32f);
    EXPECT_FLOAT_EQ(bark.reflectance.r, 0.15f);
    EXPECT_EQ(bark.transmittance, glm::vec3(0.f));
}

TEST(Patches, OriginsNameThePartAndNormalOfEverything) {
    PatchOrigins origins;
    PatchOptions options;
    options.leaf_subdivisions = 2;
    const PatchScene scene = make_patches(small_tree(), options, &origins);
    EXPECT_EQ(origins.triangle_part.size(), scene.triangles.size());
    EXPECT_EQ(origins.normals.size(), scene.positions.size());
    EXPECT_EQ(scene.uvs.size(), scene.positions.size());
    EXPECT_EQ(origins.triangle_part.back(), 0u);
    EXPECT_EQ(origins.triangle_part.front(), 1u);
}

TEST(Patches, SubdivisionKeepsAreaAndGivesPiecesOfSimilarArea) {
    const Tree tree = small_tree();
    for (const int levels : {1, 2, 3}) {
        PatchOptions options;
        options.leaf_subdivisions = levels;
        const PatchScene scene = make_patches(tree, options);
        const std::size_t pieces = std::size_t(1) << (2 * levels);
        ASSERT_EQ(scene.patches.size(), 2 * pieces + 1);
        const double whole[2] = {2.0, 1.0};
        double sum[2] = {0, 0};
        for (std::size_t p = 0; p < 2 * pieces; ++p) {
            const Patch& patch = scene.patches[p];
            EXPECT_EQ(patch.leaf, p / pieces);
            double piece = 0;
            for (std::uint32_t t = patch.first_triangle; t < patch.first_triangle + patch.triangle_count; ++t) {
                piece += area(scene, t);
                EXPECT_EQ(scene.triangle_patch[t], p);
            }
            const double mean = whole[patch.leaf] / double(pieces);
            EXPECT_GT(piece, 0.4 * mean);
            EXPECT_LT(piece, 1.8 * mean);
            sum[patch.leaf] += piece;
        }
        EXPECT_NEAR(sum[0], 2.0, 1e-5);
        EXPECT_NEAR(sum[1], 1.0, 1e-5);
    }
}

TEST(Patches, ALeafWithoutAreaStaysOnePiece) {
    Tree tree = small_tree();
    for (int i = 4; i < 8; ++i)
        tree.parts[1].positions[std::size_t(i)] = {1, 1, 1};
    PatchOptions options;
    options.leaf_subdivisions = 2;
    EXPECT_EQ(make_patches(tree, options).patches.size(), 1u + 16u + 1u);
}

TEST(Patches, TextureMeanIsWeightedByAlphaOverTheCoordinatesInUse) {
    Tree tree = small_tree();
    auto color = std::make_shared<Image>(4, 1, 3);
    for (int x = 0; x < 4; ++x)
        color->at(x, 0)[1] = float(x) * 0.25f; // green 0, .25, .5, .75
    auto alpha = std::make_shared<Image>(4, 1, 1);
    for (int x = 0; x < 4; ++x)
        alpha->at(x, 0)[0] = x == 1 ? 1.f : x == 2 ? 0.5f : 0.f;
    tree.materials[1].base_color = glm::vec3(1.f);
    tree.materials[1].base_color_texture = color;
    EXPECT_NEAR(mean_base_color(tree, 1, TreePartKind::foliage).g, 0.375f, 0.01f);
    tree.materials[1].alpha_texture = alpha;
    EXPECT_NEAR(mean_base_color(tree, 1, TreePartKind::foliage).g, 0.5f / 1.5f, 0.01f);
    EXPECT_NEAR(optics_of(tree.materials[1], TreePartKind::foliage).reflectance.g, 0.5f / 1.5f, 1e-5f);
    for (glm::vec2& uv : tree.parts[1].uvs)
        uv.x = 0.26f + 0.2f * uv.x; // all inside texel 1, as in a palette texture
    EXPECT_NEAR(mean_base_color(tree, 1, TreePartKind::foliage).g, 0.25f, 1e-5f);
    const PatchScene scene = make_patches(tree);
    ASSERT_EQ(scene.masks.size(), 1u);
    EXPECT_EQ(scene.triangle_mask, (std::vector<std::int16_t>{0, 0, 0, 0, -1}));
}

TEST(Patches, OpticsFollowDiffuseTransmissionAndNeverExceedOne) {
    TreeMaterial material;
    material.base_color = {0.4f, 0.8f, 0.2f};
    material.diffuse_transmission = 0.25f;
    material.diffuse_transmission_color = {0.8f, 1.f, 0.4f};
    const Optics given = optics_of(material, TreePartKind::foliage);
    EXPECT_NEAR(given.reflectance.g, 0.6f, 1e-6f);
    EXPECT_NEAR(given.transmittance.b, 0.1f, 1e-6f);
    material.diffuse_transmission = -1;
    material.base_color = {1.f, 0.5f, 0.f};
    const Optics guessed = optics_of(material, TreePartKind::foliage);
    EXPECT_NEAR(guessed.reflectance.r + guessed.transmittance.r, 0.95f, 1e-6f);
    EXPECT_NEAR(guessed.transmittance.g, 0.8f * guessed.reflectance.g, 1e-6f);
    material.base_color = {std::nanf(""), -1.f, 7.f};
    const Optics mended = optics_of(material, TreePartKind::bark);
    EXPECT_EQ(mended.reflectance, glm::vec3(0, 0, 1));
}

TEST(Patches, OverridesReplaceDerivedOptics) {
    PatchOptions options;
    options.leaf_optics = Optics{glm::vec3(0.5f), glm::vec3(0.4f)};
    options.bark_albedo = glm::vec3(0.3f);
    const PatchScene scene = make_patches(small_tree(), options);
    EXPECT_EQ(scene.optics[scene.patches[1].optics].transmittance, glm::vec3(0.4f));
    EXPECT_EQ(scene.optics[scene.patches[2].optics].reflectance, glm::vec3(0.3f));
}

TEST(Patches, ContradictoryIndicesAreRefused) {
    Tree tree = small_tree();
    tree.parts[1].triangle_patch = {0, 1, 0, 1};
    EXPECT_THROW(make_patches(tree), InputError);
    tree = small_tree();
    tree.parts[1].triangle_patch[3] = 9;
    EXPECT_THROW(make_patches(tree), InputError);
    tree = small_tree();
    tree.parts[0].triangles[0].x = 77;
    EXPECT_THROW(make_patches(tree), InputError);
    EXPECT_TRUE(make_patches(Tree{}).patches.empty());
}

} // namespace
} // namespace kokage

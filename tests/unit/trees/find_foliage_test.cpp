// Which meshes of a stranger's file are leaves: names, meshes that share materials, shape, and colours for what has
// none.
#include "trees/find_foliage.h"

#include "common/services/error.h"
#include "trees/foliage_shape.h"
#include "trees/part_names.h"
#include "trees/stand_in_colors.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {
constexpr TreePartKind kLeaves = TreePartKind::foliage, kBark = TreePartKind::bark;

/// A closed-in tube of eight sides and ten rings.
SceneMesh tube(const std::string& name, int material) {
    SceneMesh mesh;
    mesh.name = mesh.mesh_name = name;
    mesh.material = material;
    for (int ring = 0; ring < 10; ++ring)
        for (int s = 0; s < 8; ++s) {
            const float angle = 2 * kPi * float(s) / 8;
            mesh.positions.emplace_back(0.1f * std::cos(angle), 0.4f * float(ring), 0.1f * std::sin(angle));
        }
    for (std::uint32_t ring = 0; ring < 9; ++ring)
        for (std::uint32_t s = 0; s < 8; ++s) {
            const std::uint32_t i = ring * 8 + s, j = ring * 8 + (s + 1) % 8;
            mesh.triangles.emplace_back(i, i + 8, j);
            mesh.triangles.emplace_back(j, i + 8, j + 8);
        }
    return mesh;
}

void add_cards(SceneMesh& mesh, int count) {
    for (int i = 0; i < count; ++i) {
        const auto first = std::uint32_t(mesh.positions.size());
        const glm::vec3 at(std::sin(float(i)), 3 + 0.01f * float(i), std::cos(float(i)));
        for (const auto& [x, z] : {std::pair{0.f, 0.f}, {0.1f, 0.f}, {0.1f, 0.1f}, {0.f, 0.1f}})
            mesh.positions.push_back(at + glm::vec3(x, 0.3f * x, z));
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
}

SceneMesh cards(const std::string& name, int material, int count = 80) {
    SceneMesh mesh;
    mesh.name = mesh.mesh_name = name;
    mesh.material = material;
    add_cards(mesh, count);
    return mesh;
}

const glm::vec3 kBrown(0.2f, 0.12f, 0.06f), kGreen(0.1f, 0.3f, 0.05f), kOrange(0.5f, 0.2f, 0.05f), kGrey(0.5f);

/// The last material is the one for surfaces without any, as readers make it.
MeshScene scene_of(std::vector<SceneMesh> meshes, const std::vector<std::pair<std::string, glm::vec3>>& materials) {
    MeshScene scene;
    scene.meshes = std::move(meshes);
    for (const auto& [name, color] : materials) {
        SceneMaterial& material = scene.materials.emplace_back();
        material.name = name;
        material.base_color = glm::vec4(color, 1);
    }
    scene.materials.emplace_back().name = "default";
    scene.materials.back().is_missing = true;
    return scene;
}

std::vector<TreePartKind> kinds_of(MeshScene scene) {
    return find_foliage(scene, {}, "tree.glb").kinds;
}

bool any_says(const std::vector<std::string>& notes, const std::string& words) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& note) { return note.find(words) != std::string::npos; });
}

using Kinds = std::vector<TreePartKind>;

TEST(FindFoliage, MeshesThatShareAMaterialGoByTheirOwnNames) {
    for (const char* wood : {"tree", "Trunk", "bark", "stem", "branches", "Stamm", "Baum"})
        EXPECT_EQ(kinds_of(scene_of({cards("leaves", 0), tube(wood, 0)}, {})), (Kinds{kLeaves, kBark})) << wood;
    EXPECT_EQ(kinds_of(scene_of({tube("tree", 0), cards("leaves", 0)}, {{"Material", kGrey}})),
              (Kinds{kBark, kLeaves}));
    // A node's name goes before its mesh's.
    MeshScene renamed = scene_of({cards("leaves", 0), tube("Trunk", 0)}, {});
    renamed.meshes[1].mesh_name = "leaves.001";
    EXPECT_EQ(kinds_of(renamed), (Kinds{kLeaves, kBark}));
}

TEST(FindFoliage, OneNameForTwoMaterialsIsNoEvidenceBetweenThem) {
    for (const char* name : {"leaves", "trunk", "quaking_aspen"})
        EXPECT_EQ(
            kinds_of(scene_of({cards(name, 0), tube(name, 1)}, {{"Material.001", kGreen}, {"Material.002", kBrown}})),
            (Kinds{kLeaves, kBark}))
            << name << ": colour decides";
    EXPECT_EQ(kinds_of(scene_of({cards("leaves", 0), tube("leaves", 1)}, {{"m", kOrange}, {"bark", kBrown}})),
              (Kinds{kLeaves, kBark}))
        << "one of them is known by its material: the name means the other";
    EXPECT_EQ(kinds_of(scene_of({cards("leaves", 0, 5), cards("leaves", 1, 5), tube("trunk", 2)},
                                {{"a", kOrange}, {"b", kBrown}, {"c", kBrown}})),
              (Kinds{kLeaves, kLeaves, kBark}))
        << "wood goes by another name: both are meant";
}

TEST(FindFoliage, AutumnIsFoundByNamesOfManyLanguages) {
    for (const auto& [leaf, wood] : std::vector<std::pair<const char*, const char*>>{{"Herbstlaub", "Rinde"},
                                                                                     {"Blätter", "Stamm"},
                                                                                     {"BLÄTTER", "HOLZ"},
                                                                                     {"Nadeln", "Ast_01"},
                                                                                     {"feuillage", "écorce"},
                                                                                     {"hojas", "tronco"},
                                                                                     {"ha", "miki"},
                                                                                     {"Ha.001", "eda"},
                                                                                     {"happa", "juhi"},
                                                                                     {"foglie", "corteccia"}})
        EXPECT_EQ(kinds_of(scene_of({cards("a", 0, 5), tube("b", 1)}, {{leaf, kOrange}, {wood, kBrown}})),
                  (Kinds{kLeaves, kBark}))
            << leaf;
    for (const char* name : {"shadow", "Material", "Laubbaum", "Hals", "fast", "Masts", "leafless", "blattlos", "Edam"})
        EXPECT_FALSE(sense_of_name(name).kind) << name;
}

TEST(FindFoliage, OfLeavesAndWoodInOneNameTheLastCounts) {
    for (const char* name : {"branch_leaves", "TrunkLeaves", "twig leaf", "leaf_brown", "wood_fern"})
        EXPECT_EQ(sense_of_name(name).kind, kLeaves) << name;
    for (const char* name :
         {"leaf_stem", "pine_trunk_leaf_litter", "leafless_branch", "Blattstamm", "brown", "fall_bark"})
        EXPECT_EQ(sense_of_name(name).kind, kBark) << name;
    MeshScene scene = scene_of({cards("a", 0, 5), tube("b", 1)}, {{"leaf", kOrange}, {"leaf_stem", kBrown}});
    const FoundFoliage found = find_foliage(scene, {}, "");
    EXPECT_EQ(found.kinds, (Kinds{kLeaves, kBark}));
    EXPECT_TRUE(any_says(found.notes, "'leaf_stem' is bark: its name, of leaves and of wood, whose last word counts"));
    EXPECT_EQ(kinds_of(scene_of({cards("a", 0, 5), tube("b", 1)}, {{"leaf_branch", kOrange}, {"bark", kBrown}})),
              (Kinds{kLeaves, kBark}))
        << "nothing else speaks of leaves";
}

TEST(FindFoliage, ManySmallFlatPiecesBesideATubeAreLeaves) {
    MeshScene scene = scene_of({tube("", 0), cards("", 1)}, {{"m0", kBrown}, {"m1", kOrange}});
    const FoundFoliage found = find_foliage(scene, {}, "");
    EXPECT_EQ(found.kinds, (Kinds{kBark, kLeaves}));
    EXPECT_TRUE(any_says(found.notes, "'m1' is foliage: found by its shape: 80 small flat pieces"));
    EXPECT_EQ(kinds_of(scene_of({tube("", 0), cards("", 1, 49)}, {{"m0", kBrown}, {"m1", kOrange}})),
              (Kinds{kBark, kBark}))
        << "too few";
    EXPECT_EQ(kinds_of(scene_of({cards("", 0), cards("", 1, 5)}, {{"m0", kOrange}, {"m1", kBrown}})),
              (Kinds{kLeaves, kLeaves}))
        << "leaves alone, as some tools keep them in a file of their own";
    EXPECT_EQ(kinds_of(scene_of({tube("", 0)}, {{"m0", kBrown}})), (Kinds{kBark})) << "wood alone";
    EXPECT_EQ(kinds_of(scene_of({tube("", 0), cards("", 1)}, {{"m0", kBrown}, {"bark chips", kOrange}})),
              (Kinds{kBark, kBark}))
        << "called wood";
    // One mesh that is both is cut.
    SceneMesh both = tube("", 0);
    const std::size_t wood_triangles = both.triangles.size();
    add_cards(both, 80);
    MeshScene joined = scene_of({both}, {{"m", kGrey}});
    EXPECT_EQ(find_foliage(joined, {}, "").kinds, (Kinds{kBark, kLeaves}));
    EXPECT_EQ(joined.meshes[0].triangles.size(), wood_triangles);
    EXPECT_EQ(joined.meshes[1].triangles.size(), 160u);
}

TEST(FindFoliage, TubesAreNoFlatPieces) {
    EXPECT_EQ(small_flat_pieces(tube("", 0), 1e9).count, 0u);
    const LoosePieces pieces = small_flat_pieces(cards("", 0), 1);
    EXPECT_EQ(pieces.count, 80u);
    EXPECT_DOUBLE_EQ(pieces.share, 1);
    EXPECT_EQ(small_flat_pieces(cards("", 0), 0.01).count, 0u) << "too large";
    EXPECT_EQ(small_flat_pieces(SceneMesh(), 1).share, 0);
}

TEST(FindFoliage, WhatHasNoMaterialGetsAStatedColor) {
    MeshScene scene = scene_of({cards("leaves", 0), tube("tree", 0)}, {});
    const std::vector<std::string> notes = stand_in_for_lost_colors(scene, find_foliage(scene, {}, "").kinds);
    const auto color = [&](std::size_t m) {
        return glm::vec3(scene.materials[std::size_t(scene.meshes[m].material)].base_color);
    };
    EXPECT_EQ(color(0), glm::vec3(0.10f, 0.25f, 0.06f));
    EXPECT_EQ(color(1), glm::vec3(0.15f, 0.10f, 0.07f));
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_TRUE(
        any_says(notes, "bark without a material (mesh 'tree') takes average bark's: it reflects 0.15, 0.10, 0.07"));
    EXPECT_TRUE(any_says(notes, "leaves without a material (mesh 'leaves')"));
    // Vertex colours are colours, and a material that is there is believed.
    MeshScene colored = scene_of({tube("a", 1), tube("b", 0)}, {{"white", glm::vec3(1.f)}});
    colored.meshes[0].colors.assign(colored.meshes[0].positions.size(), glm::vec4(0.4f));
    EXPECT_TRUE(stand_in_for_lost_colors(colored, {kBark, kBark}).empty());
    EXPECT_EQ(colored.meshes[0].material, 1);
    EXPECT_EQ(colored.meshes[1].material, 0);
}

} // namespace
} // namespace kokage

// What is written comes back, bit for bit; COLOR_0 shows the shading; edited files are noticed.
#include "trees/read_tree.h"

#include "common/gltf/gltf_scene.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "tests/support/program_run.h"
#include "tests/support/tree_files.h"
#include "trees/patches.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

namespace kokage {
namespace {

void expect_same_texture(const std::shared_ptr<const Image>& a, const std::shared_ptr<const Image>& b) {
    ASSERT_EQ(bool(a), bool(b));
    if (!a)
        return;
    EXPECT_EQ(a->width, b->width);
    EXPECT_EQ(a->height, b->height);
    ASSERT_EQ(a->pixels.size(), b->pixels.size());
    float worst = 0;
    for (std::size_t i = 0; i < a->pixels.size(); ++i)
        worst = std::max(worst, std::abs(a->pixels[i] - b->pixels[i]));
    EXPECT_LE(worst, 0.005f); // 8 bits
}

void expect_same_tree(const Tree& a, const Tree& b) {
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.source, b.source);
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.notes, b.notes);
    EXPECT_EQ(a.branching_known, b.branching_known);
    EXPECT_EQ(a.bark_patch_count, b.bark_patch_count);
    ASSERT_EQ(a.skeleton.branches.size(), b.skeleton.branches.size());
    for (std::size_t i = 0; i < a.skeleton.branches.size(); ++i) {
        const Branch &x = a.skeleton.branches[i], &y = b.skeleton.branches[i];
        ASSERT_EQ(x.parent, y.parent);
        ASSERT_EQ(x.order, y.order);
        ASSERT_EQ(x.nodes.size(), y.nodes.size());
        for (std::size_t n = 0; n < x.nodes.size(); ++n) {
            ASSERT_EQ(x.nodes[n].position, y.nodes[n].position);
            ASSERT_EQ(x.nodes[n].radius_m, y.nodes[n].radius_m);
        }
    }
    ASSERT_EQ(a.leaves.size(), b.leaves.size());
    for (std::size_t i = 0; i < a.leaves.size(); ++i) {
        ASSERT_EQ(a.leaves[i].centre, b.leaves[i].centre);
        ASSERT_EQ(a.leaves[i].branch, b.leaves[i].branch);
    }
    ASSERT_EQ(a.parts.size(), b.parts.size());
    for (std::size_t p = 0; p < a.parts.size(); ++p) {
        EXPECT_EQ(a.parts[p].kind, b.parts[p].kind);
        EXPECT_EQ(a.parts[p].material, b.parts[p].material);
        EXPECT_TRUE(a.parts[p].positions == b.parts[p].positions);
        EXPECT_TRUE(a.parts[p].normals == b.parts[p].normals);
        EXPECT_TRUE(a.parts[p].uvs == b.parts[p].uvs);
        EXPECT_TRUE(a.parts[p].triangles == b.parts[p].triangles);
        EXPECT_TRUE(a.parts[p].triangle_patch == b.parts[p].triangle_patch);
    }
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (std::size_t m = 0; m < a.materials.size(); ++m) {
        const TreeMaterial &x = a.materials[m], &y = b.materials[m];
        EXPECT_EQ(x.name, y.name);
        EXPECT_EQ(x.base_color, y.base_color);
        EXPECT_EQ(x.double_sided, y.double_sided);
        EXPECT_EQ(x.roughness, y.roughness);
        EXPECT_EQ(x.diffuse_transmission, y.diffuse_transmission);
        EXPECT_EQ(x.diffuse_transmission_color, y.diffuse_transmission_color);
        EXPECT_EQ(x.wrap_u, y.wrap_u);
        EXPECT_EQ(x.wrap_v, y.wrap_v);
        EXPECT_EQ(x.alpha_texture ? x.alpha_cutoff : 0.f, x.alpha_texture ? y.alpha_cutoff : 0.f);
        expect_same_texture(x.base_color_texture, y.base_color_texture);
        expect_same_texture(x.alpha_texture, y.alpha_texture);
        ASSERT_EQ(bool(x.height_texture), bool(y.height_texture));
        if (x.height_texture) {
            EXPECT_EQ(x.height_texture->width, y.height_texture->width);
            EXPECT_TRUE(x.height_texture->pixels == y.height_texture->pixels);
        }
        EXPECT_EQ(x.height_depth_m, y.height_depth_m);
        EXPECT_EQ(x.height_tile_m, y.height_tile_m);
    }
}

/// An oak whose foliage has a checkered mask, a transmission and an odd place: everything that a file must keep.
Tree rich_tree() {
    Tree tree = small_oak();
    tree.origin = {1e7 + 0.125, -3.5, 1.0 / 3.0};
    tree.notes = {"a note with \"quotes\" and umlauts: Bäume"};
    TreePart* foliage = nullptr;
    for (TreePart& part : tree.parts)
        if (part.kind == TreePartKind::foliage)
            foliage = &part;
    if (foliage->uvs.empty())
        foliage->uvs.assign(foliage->positions.size(), glm::vec2(0.3f, 0.7f));
    TreeMaterial& material = tree.materials[foliage->material];
    auto alpha = std::make_shared<Image>(8, 4, 1);
    auto color = std::make_shared<Image>(8, 4, 3);
    for (std::size_t i = 0; i < alpha->pixels.size(); ++i) {
        alpha->pixels[i] = i % 3 == 0 ? 1.f : 0.2f;
        for (std::size_t c = 0; c < 3; ++c)
            color->pixels[3 * i + c] = float((i * 7 + c) % 11) / 11.f;
    }
    material.alpha_texture = alpha;
    material.base_color_texture = color;
    material.alpha_cutoff = 0.4f;
    material.wrap_u = TextureWrap::mirror;
    material.wrap_v = TextureWrap::clamp;
    material.diffuse_transmission = 0.3f;
    material.diffuse_transmission_color = {0.5f, 0.7f, 0.1f};
    return tree;
}

std::size_t with_heights(const Tree& tree) {
    return std::size_t(std::count_if(tree.materials.begin(), tree.materials.end(),
                                     [](const TreeMaterial& material) { return bool(material.height_texture); }));
}

TEST(TreeFile, BarksHeightsComeBackAndAreShared) {
    TemporaryFolder folder;
    Tree tree = small_oak(30);
    ASSERT_GT(with_heights(tree), 0u);
    TreeMaterial twin = tree.materials[tree.parts[0].material];
    ASSERT_TRUE(twin.height_texture);
    twin.height_depth_m *= 3;
    tree.materials.push_back(twin);
    write_tree(folder / "tree.glb", tree);
    const Tree found = read_tree(folder / "tree.glb");
    expect_same_tree(tree, found);
    EXPECT_EQ(found.materials.back().height_texture, found.materials[tree.parts[0].material].height_texture);
}

TEST(TreeFile, APlainTreeComesBackBitForBit) {
    TemporaryFolder folder;
    for (const Tree& tree : {small_oak(), rich_tree()}) {
        write_tree(folder / "tree.glb", tree);
        expect_same_tree(tree, read_tree(folder / "tree.glb"));
    }
}

TEST(TreeFile, AShadedTreeComesBackWithItsLight) {
    TemporaryFolder folder;
    const Tree tree = rich_tree();
    const ShadedAttributes light = random_light(tree);
    for (const bool split : {false, true}) {
        write_tree(folder / "tree.glb", tree, &light, {.split_sides = split});
        expect_same_tree(tree, read_tree(folder / "tree.glb"));
        const ShadedAttributes back = read_shaded(folder / "tree.glb");
        ASSERT_EQ(back.radiance_front.size(), light.radiance_front.size());
        for (std::size_t i = 0; i < light.radiance_front.size(); ++i) {
            ASSERT_EQ(back.radiance_front[i], light.radiance_front[i]) << "patch " << i;
            ASSERT_EQ(back.indirect_front[i], light.indirect_front[i]) << "patch " << i;
            const bool leaf = i < tree.leaves.size();
            ASSERT_EQ(back.radiance_back[i], leaf ? light.radiance_back[i] : glm::vec3(0.f)) << "patch " << i;
            ASSERT_EQ(back.indirect_back[i], leaf ? light.indirect_back[i] : glm::vec3(0.f)) << "patch " << i;
        }
        ASSERT_EQ(back.light_maps.size(), light.light_maps.size());
        for (std::size_t m = 0; m < light.light_maps.size(); ++m) {
            EXPECT_EQ(back.light_maps[m].position, light.light_maps[m].position);
            EXPECT_EQ(back.light_maps[m].radius_m, light.light_maps[m].radius_m);
            EXPECT_EQ(back.light_maps[m].generation, light.light_maps[m].generation);
            EXPECT_EQ(back.light_maps[m].bands, light.light_maps[m].bands);
            EXPECT_TRUE(back.light_maps[m].coefficients == light.light_maps[m].coefficients);
        }
    }
    EXPECT_THROW(
        {
            write_tree(folder / "plain.glb", tree);
            read_shaded(folder / "plain.glb");
        },
        InputError);
}

TEST(TreeFile, ColorsAreMeanRadianceOverBaseColorOverThe99thPercentile) {
    TemporaryFolder folder;
    const Tree tree = rich_tree();
    const ShadedAttributes light = random_light(tree);
    write_tree(folder / "tree.glb", tree, &light);
    const float scale = read_shaded(folder / "tree.glb").scale;
    // The slow way: every patch's value, sorted.
    std::vector<float> values;
    std::vector<glm::vec3> wanted(tree.leaves.size() + tree.bark_patch_count);
    for (const TreePart& part : tree.parts) {
        const glm::vec3 base = mean_base_color(tree, part.material, part.kind);
        for (const std::uint32_t patch : part.triangle_patch) {
            const bool leaf = part.kind == TreePartKind::foliage;
            const std::size_t i = patch + (leaf ? 0 : tree.leaves.size());
            wanted[i] =
                (leaf ? 0.5f * (light.radiance_front[i] + light.radiance_back[i]) : light.radiance_front[i]) / base;
        }
    }
    for (const glm::vec3& value : wanted)
        values.insert(values.end(), {value.r, value.g, value.b});
    std::sort(values.begin(), values.end());
    EXPECT_FLOAT_EQ(scale, values[values.size() * 99 / 100]);

    const GltfDocument document = GltfDocument::read(folder / "tree.glb");
    const MeshScene scene = flatten(document);
    std::size_t at_one = 0, all = 0;
    for (const SceneMesh& mesh : scene.meshes) {
        ASSERT_FALSE(mesh.colors.empty());
        const bool leaf = mesh.custom_attributes.contains("_RADIANCE_FRONT");
        EXPECT_EQ(leaf, !mesh.custom_attributes.contains("_RADIANCE"));
        EXPECT_TRUE(scene.materials[std::size_t(mesh.material)].unlit);
        for (const glm::vec4& color : mesh.colors)
            for (std::size_t c = 0; c < 3; ++c) {
                EXPECT_GE(color[c], 0.f);
                EXPECT_LE(color[c], 1.f);
                at_one += color[c] == 1.f;
                ++all;
            }
    }
    EXPECT_GT(at_one, 0u);
    EXPECT_LT(double(at_one) / double(all), 0.05);
    // Each leaf's first corner.
    const SceneMesh& first = scene.meshes[0];
    const TreePart& part = tree.parts[0];
    for (std::size_t t = 0; t < part.triangles.size(); t += 97) {
        const std::size_t i = part.triangle_patch[t] + (part.kind == TreePartKind::foliage ? 0 : tree.leaves.size());
        const glm::vec3 color(first.colors[first.triangles[t].x]),
            expected = glm::min(wanted[i] / scale, glm::vec3(1.f));
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(color[c], expected[c], 1e-5f * std::max(1.f, expected[c]));
    }
}

TEST(TreeFile, SplitSidesAreTwoSheetsThatFaceApart) {
    TemporaryFolder folder;
    const Tree tree = small_oak(50);
    const ShadedAttributes light = random_light(tree);
    write_tree(folder / "tree.glb", tree, &light, {.split_sides = true});
    const MeshScene scene = flatten(GltfDocument::read(folder / "tree.glb"));
    std::vector<const SceneMesh*> sheets;
    for (const SceneMesh& mesh : scene.meshes)
        if (mesh.custom_attributes.contains("_RADIANCE_FRONT"))
            sheets.push_back(&mesh);
    ASSERT_EQ(sheets.size(), 2u);
    for (const SceneMesh* sheet : sheets)
        EXPECT_FALSE(scene.materials[std::size_t(sheet->material)].double_sided);
    ASSERT_EQ(sheets[0]->triangles.size(), sheets[1]->triangles.size());
    for (std::size_t t = 0; t < sheets[0]->triangles.size(); ++t) {
        const glm::uvec3 a = sheets[0]->triangles[t], b = sheets[1]->triangles[t];
        EXPECT_EQ(sheets[0]->positions[a.x], sheets[1]->positions[b.x]);
        EXPECT_EQ(sheets[0]->positions[a.y], sheets[1]->positions[b.z]);
        EXPECT_EQ(sheets[0]->normals[a.x], -sheets[1]->normals[b.x]);
    }
}

TEST(TreeFile, WhatCannotBeWrittenIsRefused) {
    TemporaryFolder folder;
    const Tree tree = small_oak(20);
    ShadedAttributes light = random_light(tree);
    light.radiance_back[3].g = std::nanf("");
    EXPECT_THROW(write_tree(folder / "tree.glb", tree, &light), InputError);
    light = random_light(tree);
    light.radiance_front.pop_back();
    EXPECT_THROW(write_tree(folder / "tree.glb", tree, &light), InputError);
    Tree broken = tree;
    broken.parts[0].positions[0].x = INFINITY;
    EXPECT_THROW(write_tree(folder / "tree.glb", broken), InputError);
    broken = tree;
    broken.parts[0].triangles[0].x = 99999999;
    EXPECT_THROW(write_tree(folder / "tree.glb", broken), InputError);
    EXPECT_THROW(write_tree(folder / "no such folder" / "tree.glb", tree), InputError);
    EXPECT_TRUE(folder.files().empty()) << "nothing half-written stays";
}

TEST(TreeFile, BlackLightAndTreesWithoutLeavesAreWritten) {
    TemporaryFolder folder;
    Tree tree = small_oak(20);
    ShadedAttributes black = random_light(tree);
    for (auto* values : {&black.radiance_front, &black.radiance_back, &black.indirect_front, &black.indirect_back})
        values->assign(values->size(), glm::vec3(0.f));
    write_tree(folder / "black.glb", tree, &black);
    EXPECT_EQ(read_shaded(folder / "black.glb").radiance_front[5], glm::vec3(0.f));
    tree.leaves.clear();
    for (TreePart& part : tree.parts)
        if (part.kind == TreePartKind::foliage) {
            TreePart empty;
            empty.kind = TreePartKind::foliage;
            empty.material = part.material;
            part = empty;
        }
    write_tree(folder / "bare.glb", tree);
    expect_same_tree(tree, read_tree(folder / "bare.glb"));
    Tree nothing;
    nothing.name = "nothing";
    write_tree(folder / "nothing.glb", nothing);
    expect_same_tree(nothing, read_tree(folder / "nothing.glb"));
}

TEST(TreeFile, ScaleAppliesToOwnFiles) {
    TemporaryFolder folder;
    const Tree tree = small_oak(20);
    write_tree(folder / "tree.glb", tree);
    const Tree scaled = read_tree(folder / "tree.glb", {.scale = 0.5});
    EXPECT_EQ(scaled.parts[0].positions[7], 0.5f * tree.parts[0].positions[7]);
    EXPECT_EQ(scaled.leaves[3].centre, 0.5f * tree.leaves[3].centre);
    EXPECT_EQ(scaled.skeleton.branches[1].nodes[0].radius_m, 0.5f * tree.skeleton.branches[1].nodes[0].radius_m);
    EXPECT_TRUE(scaled.branching_known);
    const std::uint32_t bark = tree.parts[0].material;
    EXPECT_GT(tree.materials[bark].height_depth_m, 0);
    EXPECT_EQ(scaled.materials[bark].height_depth_m, 0.5f * tree.materials[bark].height_depth_m);
    EXPECT_EQ(scaled.materials[bark].height_tile_m, 0.5f * tree.materials[bark].height_tile_m);
}

TEST(TreeFile, AnEditedFileIsReadLikeAnybodys) {
    TemporaryFolder folder;
    const Tree tree = small_oak(200);
    write_tree(folder / "tree.glb", tree);
    std::string bytes = read_text(folder / "tree.glb");
    // Another program moved a vertex: one mantissa bit of a float in the middle of the positions.
    const GltfDocument document = GltfDocument::read(folder / "tree.glb");
    const auto& accessor =
        document.model().accessors[std::size_t(document.model().meshes[0].primitives[0].attributes.at("POSITION"))];
    const std::size_t json_length = *reinterpret_cast<const std::uint32_t*>(bytes.data() + 12);
    const std::size_t place =
        20 + json_length + 8 + document.model().bufferViews[std::size_t(accessor.bufferView)].byteOffset + 12 * 5 + 1;
    bytes[place] = char(bytes[place] ^ 1);
    std::ofstream(folder / "edited.glb", std::ios::binary) << bytes;
    const Tree edited = read_tree(folder / "edited.glb");
    EXPECT_FALSE(edited.branching_known);
    ASSERT_FALSE(edited.notes.empty());
    EXPECT_NE(edited.notes[0].find("edited"), std::string::npos) << edited.notes[0];
    EXPECT_GE(edited.leaves.size(), tree.leaves.size()) << "an oak's leaves are found again from their shape";
}

} // namespace
} // namespace kokage

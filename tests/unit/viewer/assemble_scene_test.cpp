#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/stopwatch.h"
#include "foliage/method.h"
#include "tests/support/gltf_text.h"
#include "tests/support/temporary_folder.h"
#include "viewer/scene/assemble_scene.h"
#include "viewer/scene/render_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

namespace kokage {
namespace {

PlacedTree tree_at(const std::string& species, int leaves, const glm::dvec3& at, std::uint64_t seed = 1) {
    PlacedTree placed;
    placed.source.name = species;
    placed.source.leaves = leaves;
    placed.seed = seed;
    placed.placement.at = at;
    placed.pointer = "/trees/0";
    return placed;
}

PlacedObject object_at(const std::filesystem::path& file, const glm::dvec3& at, const std::string& material = "") {
    PlacedObject placed;
    placed.file = file;
    placed.placement.at = at;
    placed.material = material;
    placed.pointer = "/objects/0";
    return placed;
}

SceneDescription constant_scene() {
    SceneDescription description;
    description.name = "test";
    description.surroundings.environment = "constant";
    description.picture.width = 24;
    description.picture.height = 18;
    description.picture.samples = 16;
    return description;
}

void write_text(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
}

/// A ball about (5, 1, 7), with a material of its own kind or none.
std::filesystem::path write_ball(const TemporaryFolder& folder, int rings = 24) {
    std::ostringstream text;
    text << "o ball\n";
    for (int i = 0; i <= rings; ++i)
        for (int j = 0; j < 2 * rings; ++j) {
            const double polar = kPiDouble * i / rings, around = kPiDouble * j / rings;
            text << "v " << 5 + std::sin(polar) * std::sin(around) << ' ' << 1 + std::cos(polar) << ' '
                 << 7 + std::sin(polar) * std::cos(around) << '\n';
        }
    const auto vertex = [&](int i, int j) { return 1 + i * 2 * rings + j % (2 * rings); };
    for (int i = 0; i < rings; ++i)
        for (int j = 0; j < 2 * rings; ++j)
            text << "f " << vertex(i, j) << ' ' << vertex(i + 1, j) << ' ' << vertex(i + 1, j + 1) << ' '
                 << vertex(i, j + 1) << '\n';
    write_text(folder / "ball.obj", text.str());
    return folder / "ball.obj";
}

double area_of(const PatchScene& scene) {
    double sum = 0;
    for (const double area : solid_areas(scene))
        sum += area;
    return sum;
}

AssembledScene assembled(const SceneDescription& description) {
    return assemble_scene(description, silent_progress());
}

RenderedScene rendered(const SceneDescription& description, RenderMethod method = RenderMethod::fast) {
    RenderOptions options;
    options.method = method;
    options.picture = description.picture;
    return render_scene(assembled(description), options, silent_progress());
}

std::string complaint(const SceneDescription& description) {
    try {
        assembled(description);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(AssembleScene, TreesStandWhereTheyArePlaced) {
    SceneDescription description = constant_scene();
    description.trees = {tree_at("oak", 80, {0, 0, 0}), tree_at("oak", 80, {6, 0.5, -2})};
    description.trees[1].placement.turn_degrees = 90;
    description.trees[1].placement.size = 0.5;
    const AssembledScene scene = assembled(description);
    ASSERT_EQ(scene.tree.leaves.size(), 160u);
    for (std::size_t i = 0; i < 80; ++i) {
        const glm::vec3 own = scene.tree.leaves[i].centre;
        const glm::vec3 expected = 0.5f * glm::vec3(own.z, own.y, -own.x) + glm::vec3(6, 0.5f, -2);
        EXPECT_LT(glm::distance(scene.tree.leaves[80 + i].centre, expected), 1e-5f);
    }
    EXPECT_FLOAT_EQ(scene.foot_height, 0);
}

TEST(AssembleScene, ReliefGrowsWithItsTree) {
    SceneDescription description = constant_scene();
    description.trees = {tree_at("oak", 50, {0, 0, 0}), tree_at("oak", 50, {20, 0, 0}), tree_at("oak", 50, {9, 0, 9})};
    description.trees[1].placement.size = 2;
    const AssembledScene scene = assemble_scene(description, silent_progress());
    std::vector<float> depths;
    for (const SurfaceLook& look : scene.looks)
        if (look.relief.heights)
            depths.push_back(look.relief.depth_m);
    ASSERT_GE(depths.size(), 2u);
    const auto [least, most] = std::minmax_element(depths.begin(), depths.end());
    EXPECT_FLOAT_EQ(*most, 2 * *least);
    // The third is the first once more, in the same clothes: it shares the materials.
    const std::size_t parts = scene.tree.parts.size() / 3;
    EXPECT_EQ(scene.tree.parts[0].material, scene.tree.parts[2 * parts].material);
    EXPECT_NE(scene.tree.parts[0].material, scene.tree.parts[parts].material);
}

/// Depths of an oak's own relief whose bark wears this, and what is warned of.
std::pair<std::vector<float>, std::vector<std::string>> bark_reliefs(const std::optional<ReliefDescription>& relief,
                                                                     bool on_leaves = false) {
    SceneDescription description = constant_scene();
    description.trees = {tree_at("oak", 50, {0, 0, 0})};
    description.materials["worn"].relief = relief;
    description.materials["worn"].pointer = "/materials/worn";
    (on_leaves ? description.trees[0].leaf_material : description.trees[0].bark_material) = "worn";
    const AssembledScene scene = assembled(description);
    std::vector<float> depths;
    for (const SurfaceLook& look : scene.looks)
        if (look.relief.heights)
            depths.push_back(look.relief.depth_m);
    return {depths, scene.report.warnings};
}

TEST(AssembleScene, BarksOwnReliefIsScaledSetOrLeftOut) {
    const auto [own, quiet] = bark_reliefs(std::nullopt);
    ASSERT_FALSE(own.empty());
    EXPECT_TRUE(quiet.empty());
    ReliefDescription scaled, set, none;
    scaled.scale = 2.5;
    set.depth_m = 0.07;
    none.none = true;
    const auto [deeper, quiet_too] = bark_reliefs(scaled);
    ASSERT_EQ(deeper.size(), own.size());
    for (std::size_t k = 0; k < own.size(); ++k)
        EXPECT_FLOAT_EQ(deeper[k], 2.5f * own[k]);
    EXPECT_TRUE(quiet_too.empty());
    for (const float depth : bark_reliefs(set).first)
        EXPECT_FLOAT_EQ(depth, 0.07f);
    const auto [left, still] = bark_reliefs(none);
    EXPECT_TRUE(left.empty());
    EXPECT_TRUE(still.empty());
    // Leaves have none: what is asked of them changes nothing, and is said.
    const auto [of_bark, warnings] = bark_reliefs(scaled, true);
    EXPECT_EQ(of_bark, own);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_EQ(warnings[0], "/materials/worn/relief: it changes nothing: leaves have no relief");
}

TEST(AssembleScene, ReliefOfWhatHasNoneIsWarnedOf) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    description.objects = {object_at(write_ball(folder), {0, 0, 0})};
    description.objects[0].material = "worn";
    description.materials["worn"].relief.emplace();
    description.materials["worn"].pointer = "/materials/worn";
    const std::vector<std::string> warnings = assembled(description).report.warnings;
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("/materials/worn/relief: it changes nothing: what wears it has no texture coordinates"),
              std::string::npos)
        << warnings[0];
}

TEST(AssembleScene, SeedsMakeDifferentTrees) {
    SceneDescription description = constant_scene();
    description.trees = {tree_at("oak", 80, {0, 0, 0}, 1), tree_at("oak", 80, {0, 0, 0}, 2)};
    const AssembledScene scene = assembled(description);
    int same = 0;
    for (std::size_t i = 0; i < 80; ++i)
        same += scene.tree.leaves[i].centre == scene.tree.leaves[80 + i].centre;
    EXPECT_LT(same, 3);
}

TEST(AssembleScene, ObjectsStandOnTheMiddleOfTheirFeet) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    description.objects = {object_at(write_ball(folder), {-3, 0.25, 4})};
    description.objects[0].height_m = 0.5;
    description.objects[0].placement.turn_degrees = 77;
    const AssembledScene scene = assembled(description);
    const Bounds bounds = bounds_of(scene.patches);
    EXPECT_LT(glm::distance(bounds.low, glm::vec3(-3.25f, 0.25f, 3.75f)), 2e-3f);
    EXPECT_LT(glm::distance(bounds.high, glm::vec3(-2.75f, 0.75f, 4.25f)), 2e-3f);
    EXPECT_FLOAT_EQ(scene.foot_height, 0.25f);
    EXPECT_NEAR(area_of(scene.patches), 4 * kPiDouble * 0.0625, 0.01);
    // Patches are small enough to carry one radiance: no normal turns by more than 60 degrees in one.
    EXPECT_GT(scene.patches.patches.size(), 100u);
    for (const Patch& patch : scene.patches.patches)
        EXPECT_EQ(patch.kind, PatchKind::bark);
}

TEST(AssembleScene, NormalTexturesOfFilesAreShownUnlessReliefIsNone) {
    const TemporaryFolder folder;
    GltfText file = GltfText::triangle();
    auto& primitive = file.json["meshes"][0]["primitives"][0];
    primitive["attributes"]["TEXCOORD_0"] = file.uvs({0, 0, 1, 0, 0, 1});
    primitive["material"] = 0;
    Image bluish(1, 1, 3);
    bluish.pixels = {0.5f, 0.5f, 1.f};
    const std::vector<std::byte> png = encode_png(bluish);
    file.json["images"] = {{{"mimeType", "image/png"}, {"bufferView", file.view(png)}}};
    file.json["textures"] = {{{"source", 0}}};
    file.json["materials"] = {{{"normalTexture", {{"index", 0}, {"scale", 0.5}}}}};
    file.node({{"mesh", 0}});
    file.scene({0});
    file.write(folder / "slab.gltf");
    SceneDescription description = constant_scene();
    description.objects = {object_at(folder / "slab.gltf", {0, 0, 0}),
                           object_at(folder / "slab.gltf", {3, 0, 0}, "even")};
    description.materials["even"].relief = ReliefDescription{};
    description.materials["even"].relief->none = true;
    const AssembledScene scene = assembled(description);
    ASSERT_EQ(scene.looks.size(), 2u);
    ASSERT_TRUE(scene.looks[0].normal_texture);
    EXPECT_FLOAT_EQ(scene.looks[0].normal_scale, 0.5f);
    EXPECT_FALSE(scene.looks[1].normal_texture);
}

TEST(AssembleScene, FilesWithZUpAreTurned) {
    const TemporaryFolder folder;
    write_text(folder / "post.obj", "v 0 0 0\nv 1 0 0\nv 0 0 5\nf 1 2 3\n");
    SceneDescription description = constant_scene();
    description.objects = {object_at(folder / "post.obj", {0, 0, 0})};
    description.objects[0].up = "z";
    const Bounds bounds = bounds_of(assembled(description).patches);
    EXPECT_NEAR(bounds.high.y - bounds.low.y, 5, 1e-5);
    EXPECT_NEAR(bounds.high.z - bounds.low.z, 0, 1e-5);
}

TEST(AssembleScene, WhatMirrorsDoesNotScatterTwice) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    description.objects = {object_at(write_ball(folder), {0, 0, 0}, "paint")};
    MaterialDescription& paint = description.materials["paint"];
    paint.base_color = glm::vec3(0.8f, 0.4f, 0.2f);
    paint.roughness = 0.3;
    AssembledScene scene = assembled(description);
    const Gloss& plastic = scene.looks[0].gloss;
    EXPECT_NEAR(plastic.normal_reflectance.r, 0.04f, 1e-6f);
    EXPECT_FLOAT_EQ(plastic.roughness, 0.3f);
    const glm::vec3 kept = 1.f - mean_gloss_reflectance(glm::vec3(0.04f), 0.3f);
    EXPECT_LT(glm::distance(scene.patches.optics[0].reflectance, kept * *paint.base_color), 1e-6f);

    paint.metallic = 1;
    scene = assembled(description);
    EXPECT_LT(glm::distance(scene.looks[0].gloss.normal_reflectance, *paint.base_color), 1e-6f);
    EXPECT_EQ(scene.patches.optics[0].reflectance, glm::vec3(0.f));

    paint.metallic = 0;
    paint.index_of_refraction = 1;
    scene = assembled(description);
    EXPECT_TRUE(scene.looks[0].gloss.is_matt());
    EXPECT_LT(glm::distance(scene.patches.optics[0].reflectance, *paint.base_color), 1e-6f);
}

TEST(AssembleScene, RoughnessChangesFromFootToTop) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    const std::filesystem::path ball = write_ball(folder);
    description.objects = {object_at(ball, {0, 1, 0}, "paint"), object_at(ball, {4, 0, 0}, "paint")};
    description.materials["paint"].roughness_from_foot_to_top = glm::dvec2(0.8, 0.2);
    const AssembledScene scene = assembled(description);
    ASSERT_EQ(scene.looks.size(), 2u); // one a ball: they stand at different heights
    const auto& first = scene.looks[0].gloss.roughness_gradient;
    ASSERT_TRUE(first);
    EXPECT_NEAR(first->at(1), 0.8f, 1e-5f);
    EXPECT_NEAR(first->at(2), 0.5f, 1e-5f);
    EXPECT_NEAR(first->at(9), 0.2f, 1e-5f);
    EXPECT_NEAR(scene.looks[1].gloss.roughness_gradient->at(1), 0.5f, 1e-5f);
}

/// Pixels within `low` and `high` by the fast way; the path tracer's roulette ends one in a hundred white paths and
/// pays the others for it, so of its pixels the mean is judged.
void expect_to_vanish(const SceneDescription& description, float low, float high) {
    const Picture fast = rendered(description).picture,
                  traced = rendered(description, RenderMethod::path_traced).picture;
    for (const Picture* picture : {&fast, &traced}) {
        double sum = 0, seen = 0;
        for (const float value : picture->radiance.pixels)
            sum += double(value);
        for (const float share : picture->subject.pixels)
            seen += double(share);
        EXPECT_NEAR(sum / double(picture->radiance.pixels.size()), 1, 0.01);
        EXPECT_GT(seen, 20);
    }
    for (const float value : fast.radiance.pixels) {
        EXPECT_GT(value, low);
        EXPECT_LT(value, high);
    }
}

TEST(AssembleScene, AMatteWhiteObjectInEvenLightVanishes) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    description.objects = {object_at(write_ball(folder), {0, 0, 0}, "white")};
    description.materials["white"].base_color = glm::vec3(1.f);
    description.materials["white"].index_of_refraction = 1;
    expect_to_vanish(description, 0.99f, 1.01f);
}

/// A rough gloss has the same reflectance from everywhere; all it loses is what lies below the horizon.
TEST(AssembleScene, AGlossyWhiteObjectInEvenLightNearlyVanishes) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    description.objects = {object_at(write_ball(folder), {0, 0, 0}, "white")};
    description.materials["white"].base_color = glm::vec3(1.f);
    description.materials["white"].roughness = 1;
    expect_to_vanish(description, 0.97f, 1.01f);
}

TEST(AssembleScene, TwoTreesFarApartAreLitAsEachAlone) {
    SceneDescription description = constant_scene();
    const PlacedTree one = tree_at("oak", 100, {0, 0, 0}, 1), two = tree_at("oak", 100, {400, 0, 0}, 2);
    const auto leaf_light = [&](const std::vector<PlacedTree>& trees) {
        description.trees = trees;
        const AssembledScene scene = assembled(description);
        ShadingOptions options;
        options.error = 0.05;
        const auto transport = make_transport(scene.patches, scene.tree, options, silent_progress());
        return transport->solve(scene.environment, silent_progress()).radiance;
    };
    const SideRadiance both = leaf_light({one, two});
    const SideRadiance singles[] = {leaf_light({one}), leaf_light({two})};
    for (std::size_t tree = 0; tree < 2; ++tree) {
        double difference = 0, mean = 0;
        for (std::size_t i = 0; i < 100; ++i) {
            difference += double(std::abs(both.front[100 * tree + i].g - singles[tree].front[i].g));
            mean += double(singles[tree].front[i].g);
        }
        EXPECT_LT(difference, 0.07 * mean) << tree;
        EXPECT_GT(mean, 0);
    }
}

TEST(AssembleScene, EmptyAndTinyScenesAreDrawn) {
    SceneDescription description = constant_scene();
    description.surroundings.environment = "sky";
    for (const RenderMethod method : {RenderMethod::fast, RenderMethod::path_traced})
        for (const float value : rendered(description, method).picture.radiance.pixels)
            EXPECT_TRUE(std::isfinite(value));
    description.trees = {tree_at("oak", 1, {0, 0, 0})};
    for (const RenderMethod method : {RenderMethod::fast, RenderMethod::path_traced})
        for (const float value : rendered(description, method).picture.radiance.pixels)
            EXPECT_TRUE(std::isfinite(value));
}

TEST(AssembleScene, PicturesAreTheSameWithAnyNumberOfThreads) {
    const TemporaryFolder folder;
    SceneDescription description = constant_scene();
    description.surroundings.environment = "sky";
    description.trees = {tree_at("oak", 200, {0, 0, 0}), tree_at("birch", 200, {3, 0, 1})};
    description.objects = {object_at(write_ball(folder, 8), {1, 0, 3})};
    set_thread_count(1);
    const Picture one = rendered(description).picture;
    set_thread_count(3);
    const Picture three = rendered(description).picture;
    set_thread_count(0);
    EXPECT_EQ(one.radiance.pixels, three.radiance.pixels);
}

TEST(AssembleScene, AbsurdScenesAreRefusedAtOnce) {
    SceneDescription description = constant_scene();
    for (int i = 0; i < 10000; ++i)
        description.trees.push_back(tree_at("oak", 1000000, {10. * i, 0, 0}, std::uint64_t(i)));
    const Stopwatch watch;
    const std::string said = complaint(description);
    EXPECT_NE(said.find("fewer trees"), std::string::npos) << said;
    EXPECT_LT(watch.wall(), 5);
    description.trees.clear();
    description.picture.width = description.picture.height = 30000;
    description.picture.layers = true;
    if (const std::string picture = complaint(description); !picture.empty()) {
        EXPECT_NE(picture.find("make it smaller"), std::string::npos) << picture;
    }
}

TEST(AssembleScene, WhatCannotBeIsRefused) {
    const TemporaryFolder folder;
    write_text(folder / "flat.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    write_text(folder / "none.obj", "v 0 0 0\n");
    SceneDescription description = constant_scene();
    description.objects = {object_at(folder / "flat.obj", {0, 0, 0})};
    description.objects[0].height_m = 1;
    EXPECT_NE(complaint(description).find("/objects/0/height: "), std::string::npos) << complaint(description);
    description.objects = {object_at(folder / "none.obj", {0, 0, 0})};
    EXPECT_NE(complaint(description).find("/objects/0: "), std::string::npos) << complaint(description);
    description.objects = {object_at(folder / "flat.obj", {0, 0, 0}, "gold")};
    EXPECT_NE(complaint(description).find("gold"), std::string::npos) << complaint(description);
    description.objects.clear();
    description.trees = {tree_at("oak", 10, {0, 0, 0})};
    description.trees[0].placement.size = 0;
    EXPECT_NE(complaint(description).find("/trees/0/size: "), std::string::npos) << complaint(description);
    description.trees[0].placement.size = 1;
    description.trees[0].placement.at.x = NAN;
    EXPECT_NE(complaint(description).find("/trees/0: "), std::string::npos) << complaint(description);
}

TEST(AssembleScene, ObjectsWithoutSizeAreRefused) {
    const TemporaryFolder folder;
    write_text(folder / "point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n");
    SceneDescription description = constant_scene();
    description.objects = {object_at(folder / "point.obj", {0, 0, 0})};
    EXPECT_NE(complaint(description).find("point.obj: it has no size"), std::string::npos) << complaint(description);
}

TEST(AssembleScene, MaterialsThatNothingWearsAreNotLoaded) {
    SceneDescription description = constant_scene();
    description.trees = {tree_at("oak", 10, {0, 0, 0})};
    description.materials["gold"].base_color_texture = "/nowhere/gold.png";
    const AssembledScene scene = assembled(description);
    ASSERT_EQ(scene.report.skips.size(), 1u);
    EXPECT_NE(scene.report.skips[0].why.find("'gold'"), std::string::npos);
}

} // namespace
} // namespace kokage

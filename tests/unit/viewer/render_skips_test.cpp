// What a picture has no use for is not made, and the report says so: on grown trees, with their own bark.
#include "common/services/error.h"
#include "viewer/scene/render_scene.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// An oak under an even sky, seen from `distance` metres.
SceneDescription oak_from(double distance) {
    SceneDescription scene;
    scene.name = "oak";
    scene.surroundings.environment = "gradient";
    scene.picture.width = 24;
    scene.picture.height = 18;
    scene.picture.samples = 4;
    scene.trees.emplace_back();
    scene.trees[0].source.name = "oak";
    scene.trees[0].source.leaves = 60;
    scene.trees[0].leaf_material = "leaf";
    scene.trees[0].bark_material = "bark";
    scene.materials["leaf"].pointer = "/materials/leaf";
    scene.materials["bark"].pointer = "/materials/bark";
    scene.camera.position = glm::dvec3(0, 0.5, distance);
    scene.camera.target = glm::dvec3(0, 0.3, 0);
    return scene;
}

struct Drawn {
    Picture picture;
    WorkReport report;

    explicit Drawn(const SceneDescription& scene, RenderOptions options = {}) {
        options.picture = scene.picture;
        const AssembledScene assembled = assemble_scene(scene, silent_progress());
        RenderedScene rendered = render_scene(assembled, options, silent_progress());
        picture = std::move(rendered.picture);
        report = std::move(rendered.report);
    }
    /// Why something was left out; empty if it wasn't.
    std::string skipped(const std::string& what) const {
        for (const WorkReport::Skip& skip : report.skips)
            if (skip.what == what)
                return skip.why;
        return "";
    }
    /// 0 if nothing of it was counted.
    std::uint64_t count(const std::string& name) const {
        for (const auto& count : report.counts)
            if (count.name == name)
                return std::uint64_t(count.value);
        return 0;
    }
};

void make_matt(SceneDescription& scene) {
    for (auto& [name, material] : scene.materials)
        material.index_of_refraction = 1;
}

TEST(RenderSkips, NoGlossNoBake) {
    SceneDescription scene = oak_from(3);
    const Drawn glossy(scene);
    EXPECT_EQ(glossy.skipped("reflection map"), "");
    EXPECT_GT(glossy.count("texels"), 100u);
    make_matt(scene);
    const Drawn matt(scene);
    EXPECT_NE(matt.skipped("reflection map").find("nothing glossy"), std::string::npos);
    EXPECT_EQ(matt.count("texels"), 0u);
}

TEST(RenderSkips, NoTexturesThatNothingWears) {
    SceneDescription scene = oak_from(3);
    scene.materials["unworn"].pointer = "/materials/unworn";
    scene.materials["unworn"].base_color_texture = "there is no such file.png";
    const AssembledScene assembled = assemble_scene(scene, silent_progress());
    ASSERT_EQ(assembled.report.skips.size(), 1u);
    EXPECT_EQ(assembled.report.skips[0].why, "nothing wears 'unworn'");
    // With the skip switched off it is looked for.
    EXPECT_THROW((void)assemble_scene(scene, silent_progress(), {.skip_unworn_materials = false}), InputError);
}

TEST(RenderSkips, NoLobesButThoseThatAreWorn) {
    SceneDescription scene = oak_from(3);
    scene.materials["leaf"].roughness = 0.6;
    scene.materials["bark"].roughness = 0.9;
    scene.materials["unworn"].roughness = 0.3;
    const Drawn rough(scene);
    scene.materials["leaf"].roughness = 0.3;
    const Drawn smooth(scene);
    EXPECT_GT(rough.count("texels"), 100u);
    EXPECT_GT(smooth.count("texels"), 2 * rough.count("texels"));
}

TEST(RenderSkips, NoLightMapsThatNothingReads) {
    SceneDescription scene = oak_from(3);
    const Drawn rough(scene);
    EXPECT_EQ(rough.skipped("light maps"), "");
    EXPECT_GT(rough.count("light maps"), 0u);
    RenderOptions rays;
    rays.light_maps = false;
    const Drawn without(scene, rays);
    EXPECT_EQ(without.count("light maps"), 0u);
    EXPECT_NE(without.picture.radiance.pixels, rough.picture.radiance.pixels);
    scene.materials["bark"].roughness = 0.2;
    const Drawn smooth(scene);
    EXPECT_NE(smooth.skipped("light maps").find("no rough, glossy bark in view"), std::string::npos);
    EXPECT_EQ(smooth.count("light maps"), 0u);
    RenderOptions all;
    all.skip_unread_light_maps = false;
    const Drawn made(scene, all);
    EXPECT_GT(made.count("light maps"), 0u);
    EXPECT_EQ(made.picture.radiance.pixels, smooth.picture.radiance.pixels);
}

TEST(RenderSkips, NoPathsThatCheckWhatIsGathered) {
    const std::string check = "check of the leaves' light by paths";
    SceneDescription scene = oak_from(3);
    EXPECT_NE(Drawn(scene).skipped(check).find("gathered anew"), std::string::npos);
    RenderOptions checked;
    checked.skip_check_by_paths = false;
    const Drawn with(scene, checked);
    EXPECT_EQ(with.skipped(check), "");
    EXPECT_GT(with.count("paths that checked the error"), 0u);
    scene.picture.gather_rays = 0; // then the picture shows what was solved
    EXPECT_GT(Drawn(scene).count("paths that checked the error"), 0u);
}

TEST(RenderSkips, ReliefOnlyWhereAQuarterPixelOfItIsSeen) {
    SceneDescription near = oak_from(0.8);
    near.trees[0].source.leaves = 2000; // a trunk of a hand's width
    near.camera.position->y = near.camera.target->y = 0.5;
    const Drawn close(near);
    EXPECT_EQ(close.skipped("relief"), "");
    EXPECT_GT(close.count("triangles with relief"), 0u);
    EXPECT_GT(close.count("bytes for relief"), 0u);
    near.materials["bark"].relief.emplace().none = true;
    const Drawn without(near);
    EXPECT_NE(without.skipped("relief").find("no material in the scene has any"), std::string::npos);
    EXPECT_NE(close.picture.radiance.pixels, without.picture.radiance.pixels);

    SceneDescription far = oak_from(300);
    const Drawn distant(far);
    EXPECT_NE(distant.skipped("relief").find("of a pixel at most; a quarter is the least that is seen"),
              std::string::npos);
    EXPECT_EQ(distant.count("triangles with relief"), 0u);
    far.materials["bark"].relief.emplace().none = true;
    EXPECT_EQ(distant.picture.radiance.pixels, Drawn(far).picture.radiance.pixels);

    SceneDescription away = oak_from(0.8);
    away.camera.target = glm::dvec3(0, 0.5, 5);
    EXPECT_EQ(Drawn(away).skipped("relief"), "no surface with relief is in view");
}

} // namespace
} // namespace kokage

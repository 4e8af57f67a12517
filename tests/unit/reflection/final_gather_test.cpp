#include "common/environment/lat_long.h"
#include "common/services/parallel.h"
#include "tests/unit/reflection/half_hidden_leaf.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

double brightness(const Image& image) {
    const glm::dvec3 mean = mean_of(image);
    return (mean.r + mean.g + mean.b) / 3;
}

/// 1.1 in the mean, bright towards +X alone.
Environment one_sided_sky() {
    Environment sky;
    sky.remainder = Image(64, 32, 3);
    for (int y = 0; y < 32; ++y)
        for (int x = 0; x < 64; ++x)
            std::fill_n(sky.remainder.at(x, y), 3, float(1.1 + pixel_direction(x, y, 64, 32).x));
    return sky;
}

TEST(FinalGather, GivesWhatIsSeenOfALeafItsOwnLight) {
    const HalfHiddenLeaf leaf;
    const double truth = brightness(leaf.traced(256));
    EXPECT_LT(brightness(leaf.solved(0).radiance), 0.7 * truth);
    EXPECT_NEAR(brightness(leaf.solved(8).radiance) / truth, 1, 0.015);
}

TEST(FinalGather, GivesFlatPatchesTheLightOfTheirLobes) {
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(0.3f);
    gloss.roughness = 0.7f;
    const HalfHiddenLeaf leaf(gloss);
    PictureOptions small = without_ground(12, 12, 8); // a patch of few pixels has one lobe's light
    const Picture gathered = leaf.solved(8, small);
    PictureOptions paths = small;
    paths.samples = 1024;
    const double truth = brightness(
        render_path_traced(leaf.scene, RayQueries(leaf.patches), leaf.sky, leaf.camera, paths, silent_progress())
            .radiance);
    EXPECT_NEAR(brightness(gathered.radiance) / truth, 1, 0.02);
}

TEST(FinalGather, GivesBentLeavesNoCommonLobe) {
    // A glossy leaf of four pleats, below a sky that is bright on one side alone: no slope would do.
    PatchScene patches;
    patches.optics = {{glm::vec3(0.f), glm::vec3(0.f)}};
    std::vector<glm::vec3> corners;
    for (int k = 0; k < 4; ++k) {
        const glm::vec3 a(0.5f * float(k) - 1, k % 2 ? 0 : 0.25f, 1), b(a.x + 0.5f, 0.25f - a.y, 1), along(0, 0, -2);
        corners.insert(corners.end(), {a, b, b + along, a, b + along, a + along});
    }
    add_leaf(patches, corners);
    ShadedScene scene = evenly_shaded(patches, glm::vec3(0.f));
    scene.looks.resize(1);
    scene.looks[0].gloss.normal_reflectance = glm::vec3(0.5f);
    scene.looks[0].gloss.roughness = 0.3f;
    scene.triangle_look.assign(patches.triangles.size(), 0);
    const Environment sky = one_sided_sky();
    PictureOptions options = without_ground(16, 16, 16);
    Camera camera = camera_at({0, 6, 0}, {0, 0.125f, 0}, 0.32f);
    camera.up = {0, 0, -1};
    const RayQueries queries(patches);
    options.gather_rays = 4;
    const Image gathered = render_picture(scene, queries, sky, camera, options, silent_progress()).radiance;
    options.samples = 256;
    const Image truth = render_path_traced(scene, queries, sky, camera, options, silent_progress()).radiance;
    for (const int first : {0, 4, 8, 12})
        EXPECT_NEAR(mean_of_columns(gathered, first, first + 4).g / mean_of_columns(truth, first, first + 4).g, 1,
                    0.03);
}

TEST(FinalGather, ChangesNothingWhereSolvedLightIsRight) {
    // One side of a lone leaf sees nothing but the sky.
    PatchScene patches;
    patches.optics = {{glm::vec3(0.4f), glm::vec3(0.2f)}};
    add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);
    const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.6f));
    PictureOptions options = without_ground(16, 16, 8);
    options.gather_rays = 4;
    const Picture picture = render_picture(scene, RayQueries(patches), constant_environment(glm::vec3(1.f)),
                                           camera_at({0, 6, 0}, {0, 0, 0}, 0.2f), options, silent_progress());
    for (const float value : picture.radiance.pixels)
        EXPECT_NEAR(value, 0.6f, 1e-4f);
}

TEST(FinalGather, GathersTheWholeOfALargePatch) {
    // More rows than are gathered at once; the leaf's far end lies in the shade of a second cover.
    HalfHiddenLeaf leaf;
    add_rectangle(leaf.patches, {0, 0.3f, 0}, {1, 0, 0}, {0, 0, -2}, 1);
    leaf.camera = camera_at({0.5f, 1.5f, 2}, {0.5f, 0, 0}, 0.12f); // sees below that one as well
    leaf.scene = evenly_shaded(leaf.patches, glm::vec3(0.f));
    leaf.scene.indirect_front[0] = leaf.scene.radiance_front[0] = 0.2f * glm::vec3(1, 2, 3);
    leaf.scene.looks.resize(1);
    leaf.scene.triangle_look.assign(leaf.patches.triangles.size(), 0);
    PictureOptions tall = without_ground(96, 160, 4);
    const double gathered = brightness(leaf.solved(8, tall).radiance);
    tall.samples = 64;
    const double truth = brightness(
        render_path_traced(leaf.scene, RayQueries(leaf.patches), leaf.sky, leaf.camera, tall, silent_progress())
            .radiance);
    EXPECT_NEAR(gathered / truth, 1, 0.02);
}

TEST(FinalGather, SpreadsTheRaysOfPatchesThatHaveEnoughAfterOnePass) {
    // Under a sky that is bright on one side; what comes from there and from the other sums up to 1.1.
    PatchScene patches;
    patches.optics = {{glm::vec3(0.6f), glm::vec3(0.f)}};
    add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);
    const ShadedScene scene = evenly_shaded(patches, glm::vec3(0.2f));
    const Environment sky = one_sided_sky();
    PictureOptions options = without_ground(64, 64, 8);
    for (const int rays : {2, 8, 16}) {
        options.gather_rays = rays; // after the first of so many passes there are rays enough
        const Picture picture = render_picture(scene, RayQueries(patches), sky, camera_at({0, 6, 0}, {0, 0, 0}, 0.2f),
                                               options, silent_progress());
        EXPECT_NEAR(brightness(picture.radiance) / (0.6 * 1.1), 1, 0.01) << rays;
    }
}

TEST(FinalGather, SpreadsTheRaysOfAPatchAsOneSequence) {
    // A black roof hides half of an even sky. Independent rays leave an error of 5 %.
    PatchScene patches;
    patches.optics = {{glm::vec3(0.6f), glm::vec3(0.f)}, {glm::vec3(0.f), glm::vec3(0.f)}};
    add_rectangle(patches, {0, 0, 0.1f}, {0.2f, 0, 0}, {0, 0, -0.2f}, 0);
    add_rectangle(patches, {-100, 1, 100}, {100, 0, 0}, {0, 0, -200}, 1);
    ShadedScene scene = evenly_shaded(patches, glm::vec3(0.f));
    scene.indirect_front[0] = scene.radiance_front[0] = glm::vec3(0.32f);
    const RayQueries queries(patches);
    const Environment sky = constant_environment(glm::vec3(1.f));
    const Camera camera = camera_at({4, 6, 0}, {0.1f, 0, 0}, 0.02f);
    const auto picture = [&](const PictureOptions& options) {
        return brightness(render_picture(scene, queries, sky, camera, options, silent_progress()).radiance);
    };
    PictureOptions options = without_ground(8, 8, 4);
    options.gather_rays = 1024;
    const double truth = picture(options);
    options.gather_rays = 4;
    double squares = 0;
    constexpr int kPictures = 24;
    for (int k = 0; k < kPictures; ++k) {
        options.seed = std::uint64_t(k) + 100;
        squares += std::pow(picture(options) / truth - 1, 2);
    }
    EXPECT_LT(std::sqrt(squares / kPictures), 0.02);
}

TEST(FinalGather, LightsWhatWasSolvedAsBlackAlsoByFewRays) {
    HalfHiddenLeaf leaf;
    leaf.scene.indirect_front[0] = glm::vec3(0.f);
    const double truth = brightness(leaf.traced(64));
    EXPECT_NEAR(brightness(leaf.solved(1, without_ground(2, 2, 4)).radiance) / truth, 1, 0.25);
}

TEST(FinalGather, IsTheSameBitsForAnyNumberOfThreads) {
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(0.04f);
    gloss.roughness = 0.5f;
    const HalfHiddenLeaf leaf(gloss);
    set_thread_count(1);
    const Image one = leaf.solved(3).radiance;
    set_thread_count(3);
    const Image three = leaf.solved(3).radiance;
    set_thread_count(0);
    EXPECT_EQ(one.pixels, three.pixels);
}

TEST(FinalGather, StaysFiniteUnderHugeAndBlackLight) {
    HalfHiddenLeaf leaf;
    leaf.scene.indirect_front[0] = glm::vec3(0.f, 1e38f, 1e-38f);
    leaf.sky = constant_environment(glm::vec3(0.f, 1e30f, 1.f));
    for (const float value : leaf.solved(4).radiance.pixels)
        EXPECT_TRUE(std::isfinite(value) && value >= 0) << value;
    leaf.scene.indirect_front[0] = glm::vec3(0.f);
    leaf.sky = constant_environment(glm::vec3(1.f));
    EXPECT_GT(brightness(leaf.solved(4).radiance), 0.3); // what was solved as black is lit all the same
}

TEST(FinalGather, IsSkippedWithoutShadowsPerPixelAndSaysSo) {
    const HalfHiddenLeaf leaf;
    PictureOptions options = without_ground(8, 8, 8);
    options.pixel_shadows = false;
    const Picture plain = leaf.solved(0, options), skipped = leaf.solved(4, options);
    EXPECT_EQ(plain.radiance.pixels, skipped.radiance.pixels);
    const auto has = [](const Picture& picture) {
        for (const WorkReport::Skip& skip : picture.report.skips)
            if (skip.what == "final gathering")
                return true;
        return false;
    };
    EXPECT_TRUE(has(skipped));
    EXPECT_FALSE(has(plain));
}

std::uint64_t rays_of(const Picture& picture, const char* name = "gathering rays") {
    for (const WorkReport::Count& count : picture.report.counts)
        if (count.name == name)
            return count.value;
    ADD_FAILURE() << "nothing is called " << name;
    return 0;
}

TEST(FinalGather, StopsWhenCornersAndPatchesHaveEnough) {
    const HalfHiddenLeaf leaf;
    EXPECT_EQ(rays_of(leaf.solved(1)), 32u * 32u);
    EXPECT_EQ(rays_of(leaf.solved(8)), 32u * 32u); // one patch of a thousand pixels
}

TEST(FinalGather, CountsRaysThatWereTraced) {
    HalfHiddenLeaf leaf;
    leaf.camera = camera_at({0, 6, 0}, {0, 0, 0}, 0.12f); // sees the black cover on the left
    const std::uint64_t rays = rays_of(leaf.solved(1));
    EXPECT_GT(rays, 32u * 14u);
    EXPECT_LT(rays, 32u * 18u);
    // A lobe has a ray of its own, but not below the horizon.
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(0.04f);
    gloss.roughness = 1;
    HalfHiddenLeaf glossy(gloss);
    glossy.patches.optics[0].reflectance = glm::vec3(0.f);
    EXPECT_GT(rays_of(glossy.solved(1)), 32u * 26u);
    glossy.camera = camera_at({2, 0.4f, 0}, {0.5f, 0, 0}, 0.12f);
    EXPECT_LT(rays_of(glossy.solved(1)), 32u * 26u);
}

TEST(FinalGather, SeeksTheSkyOnlyWhereItIsBright) {
    HalfHiddenLeaf leaf;
    EXPECT_EQ(rays_of(leaf.solved(1), "gathering rays to the sky"), 32u * 32u);
    leaf.sky = constant_environment(glm::vec3(0.f));
    EXPECT_EQ(rays_of(leaf.solved(1), "gathering rays to the sky"), 0u);
}

} // namespace
} // namespace kokage::test

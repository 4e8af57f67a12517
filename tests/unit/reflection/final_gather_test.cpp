#include "common/environment/analytic_sky.h"
#include "common/services/parallel.h"
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

Progress quiet;

PictureOptions without_ground(int width, int height, int samples) {
    PictureOptions options = small_picture(width, height, samples);
    options.ground = PictureGround::none;
    return options;
}

/// A leaf whose left half lies close under a black one. A camera above sees
/// its right half alone, and that is in the open but for what the black one hides at its side.
struct HalfHiddenLeaf {
    PatchScene patches;
    ShadedScene scene;
    Environment sky = constant_environment(glm::vec3(1, 2, 3));
    Camera camera = camera_at({0.5f, 6, 0}, {0.5f, 0, 0}, 0.12f);

    explicit HalfHiddenLeaf(const Gloss& gloss = {}) {
        patches.optics = {{glm::vec3(0.4f), glm::vec3(0.f)}, {glm::vec3(0.f), glm::vec3(0.f)}};
        add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);
        add_rectangle(patches, {-1, 0.1f, 1}, {1, 0, 0}, {0, 0, -2}, 1);
        scene = evenly_shaded(patches, glm::vec3(0.f));
        // In the mean over the leaf: half of it is as good as black.
        scene.indirect_front[0] = scene.radiance_front[0] = 0.2f * glm::vec3(1, 2, 3);
        scene.looks.resize(1);
        scene.looks[0].gloss = gloss;
        scene.triangle_look.assign(patches.triangles.size(), 0);
    }

    Picture solved(int gather_rays, const PictureOptions& base = without_ground(32, 32, 8)) const {
        PictureOptions options = base;
        options.gather_rays = gather_rays;
        return render_picture(scene, RayQueries(patches), sky, camera, options, quiet);
    }
    Image traced(int samples) const {
        return render_path_traced(scene, RayQueries(patches), sky, camera, without_ground(32, 32, samples), quiet)
            .radiance;
    }
};

double mean_of(const Image& image) {
    double sum = 0;
    for (const float value : image.pixels)
        sum += double(value);
    return sum / double(image.pixels.size());
}

TEST(FinalGather, GivesWhatIsSeenOfALeafItsOwnLight) {
    const HalfHiddenLeaf leaf;
    const double truth = mean_of(leaf.traced(256));
    EXPECT_LT(mean_of(leaf.solved(0).radiance), 0.7 * truth);
    EXPECT_NEAR(mean_of(leaf.solved(8).radiance) / truth, 1, 0.015);
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
    const double truth =
        mean_of(render_path_traced(leaf.scene, RayQueries(leaf.patches), leaf.sky, leaf.camera, paths, quiet).radiance);
    EXPECT_NEAR(mean_of(gathered.radiance) / truth, 1, 0.02);
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
                                           camera_at({0, 6, 0}, {0, 0, 0}, 0.2f), options, quiet);
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
    const double gathered = mean_of(leaf.solved(8, tall).radiance);
    tall.samples = 64;
    const double truth =
        mean_of(render_path_traced(leaf.scene, RayQueries(leaf.patches), leaf.sky, leaf.camera, tall, quiet).radiance);
    EXPECT_NEAR(gathered / truth, 1, 0.02);
}

TEST(FinalGather, LightsWhatWasSolvedAsBlackAlsoByFewRays) {
    HalfHiddenLeaf leaf;
    leaf.scene.indirect_front[0] = glm::vec3(0.f);
    const double truth = mean_of(leaf.traced(64));
    EXPECT_NEAR(mean_of(leaf.solved(1, without_ground(2, 2, 4)).radiance) / truth, 1, 0.25);
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
    EXPECT_GT(mean_of(leaf.solved(4).radiance), 0.3); // what was solved as black is lit all the same
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

TEST(FinalGather, StopsWhenCornersAndPatchesHaveEnough) {
    const HalfHiddenLeaf leaf;
    const auto rays = [&](int gather_rays) {
        for (const WorkReport::Count& count : leaf.solved(gather_rays).report.counts)
            if (count.name == "gathering rays")
                return count.value;
        return std::uint64_t(0);
    };
    EXPECT_EQ(rays(1), 32u * 32u);
    EXPECT_EQ(rays(8), rays(1)); // one patch of a thousand pixels
}

} // namespace
} // namespace kokage::test

// The parts of a picture: they add up, and each is what a scene made for it has.
#include "common/services/parallel.h"
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

/// Two leaves that face the camera (+Z), side by side over a ground, the right one farther away and glossy.
struct TwoLeaves {
    PatchScene patches;
    ShadedScene scene;
    Environment environment = constant_environment(glm::vec3(0.7f));

    TwoLeaves() {
        add_leaf(-1.f, 0.f, 0);
        add_leaf(1.f, -1.f, 1);
        patches.optics = {{glm::vec3(0.3f, 0.5f, 0.1f), glm::vec3(0.1f)}};
        patches.leaf_count = 2;
        patches.ground = Ground{-1.f, glm::vec3(0.4f)};
        environment.has_lower_half = false;
        environment.distant_lights.push_back(disc_light({0.2f, 0.5f, 1}, 0.01f, glm::vec3(2.f)));
        scene = evenly_shaded(patches, glm::vec3(0.25f));
        SurfaceLook matt, glossy;
        glossy.gloss.normal_reflectance = glm::vec3(0.04f);
        glossy.gloss.roughness = 0.4f;
        scene.looks = {matt, glossy};
        scene.triangle_look = {0, 0, 1, 1};
    }
    void add_leaf(float x, float z, std::uint32_t leaf) {
        const auto first = std::uint32_t(patches.positions.size());
        for (const glm::vec2 corner : {glm::vec2(-0.8f, -0.8f), {0.8f, -0.8f}, {0.8f, 0.8f}, {-0.8f, 0.8f}})
            patches.positions.emplace_back(x + corner.x, corner.y, z);
        patches.patches.push_back({std::uint32_t(patches.triangles.size()), 2, 0, PatchKind::leaf, leaf});
        for (const glm::uvec3 corners : {glm::uvec3(0, 1, 2), {0, 2, 3}}) {
            patches.triangles.push_back(corners + first);
            patches.triangle_patch.push_back(std::uint32_t(patches.patches.size() - 1));
        }
    }
    Picture drawn(bool by_paths, bool layers = true, bool pixel_shadows = true) const {
        const RayQueries queries(patches);
        PictureOptions options = small_picture(40, 30, 8);
        options.layers = layers;
        options.pixel_shadows = pixel_shadows;
        const Camera camera = camera_at({0, 0.3f, 6}, {0, 0, 0}, 0.8f);
        return by_paths ? render_path_traced(scene, queries, environment, camera, options, silent_progress())
                        : render_picture(scene, queries, environment, camera, options, silent_progress());
    }
};

TEST(PictureLayers, PartsAddUpToRadianceByBothMethods) {
    for (const bool by_paths : {false, true}) {
        const Picture picture = TwoLeaves().drawn(by_paths);
        ASSERT_TRUE(picture.layers);
        int covered = 0;
        for (int y = 0; y < 30; ++y)
            for (int x = 0; x < 40; ++x) {
                const PictureLayers& layers = *picture.layers;
                const glm::vec3 parts =
                    pixel(layers.direct, x, y) + pixel(layers.indirect, x, y) + pixel(layers.reflection, x, y);
                const glm::vec3 rest = pixel(picture.radiance, x, y) - parts;
                bool all_surroundings = true; // the filter reaches into the neighbours
                for (int j = std::max(0, y - 1); j <= std::min(29, y + 1); ++j)
                    for (int i = std::max(0, x - 1); i <= std::min(39, x + 1); ++i)
                        all_surroundings = all_surroundings && std::isinf(layers.depth.at(i, j)[0]);
                if (all_surroundings) {
                    EXPECT_EQ(parts, glm::vec3(0.f));
                } else if (picture.subject.at(x, y)[0] == 1 || y > 20) { // nothing of the sky is in it
                    ++covered;
                    EXPECT_LT(glm::length(rest), 1e-5f) << x << " " << y;
                }
                EXPECT_GE(rest.x, -1e-5f);
            }
        EXPECT_GT(covered, 300);
    }
}

TEST(PictureLayers, TellWhatIsSeenWhere) {
    for (const bool by_paths : {false, true}) {
        const Picture picture = TwoLeaves().drawn(by_paths);
        const PictureLayers& layers = *picture.layers;
        const int left = 13, right = 25, leaf_row = 14;
        ASSERT_EQ(picture.subject.at(left, leaf_row)[0], 1);
        ASSERT_EQ(picture.subject.at(right, leaf_row)[0], 1);
        EXPECT_EQ(layers.leaf.at(left, leaf_row)[0], 1);
        EXPECT_EQ(layers.leaf.at(right, leaf_row)[0], 2);
        EXPECT_EQ(layers.leaf.at(20, 29)[0], 0);
        EXPECT_NEAR(layers.albedo.at(left, leaf_row)[1], 0.5f, 1e-5f);
        EXPECT_GT(layers.albedo.at(20, 29)[1], 0.2f);
        EXPECT_NEAR(layers.normal.at(left, leaf_row)[2], 1, 1e-5f);
        EXPECT_NEAR(layers.normal.at(20, 29)[1], 1, 1e-5f);
        // Along the axis, which looks down a little: cos = 6 / |(6, 0.3)|.
        const double cosine = 6 / std::hypot(6., 0.3);
        EXPECT_NEAR(layers.depth.at(left, leaf_row)[0], 6 * cosine, 0.05);
        EXPECT_NEAR(layers.depth.at(right, leaf_row)[0], 7 * cosine, 0.05);
        EXPECT_TRUE(std::isinf(layers.depth.at(20, 0)[0]));
        EXPECT_GT(layers.direct.at(left, leaf_row)[1], 0.1f);
        EXPECT_EQ(layers.reflection.at(left, leaf_row)[1], 0); // matt
        EXPECT_GT(layers.reflection.at(right, leaf_row)[1], 0.01f);
    }
}

TEST(PictureLayers, SolvedLightWithoutPixelShadowsHoldsGlossOnce) {
    const Picture picture = TwoLeaves().drawn(false, true, false);
    for (const int leaf : {13, 25}) { // matt, glossy
        EXPECT_LT(glm::length(pixel(picture.radiance, leaf, 14) - glm::vec3(0.25f)), 1e-6f) << leaf;
        EXPECT_EQ(pixel(picture.layers->reflection, leaf, 14), glm::vec3(0.f)) << leaf;
    }
    ASSERT_FALSE(picture.report.skips.empty());
    EXPECT_EQ(picture.report.skips[0].what, "reflection map");
}

TEST(PictureLayers, DontChangeThePictureAndAreTheSameBitsForAnyNumberOfThreads) {
    for (const bool by_paths : {false, true}) {
        const Picture plain = TwoLeaves().drawn(by_paths, false),
                      one =
                          [&] {
                              set_thread_count(1);
                              Picture picture = TwoLeaves().drawn(by_paths);
                              set_thread_count(0);
                              return picture;
                          }(),
                      many = TwoLeaves().drawn(by_paths);
        EXPECT_FALSE(plain.layers);
        EXPECT_EQ(plain.radiance.pixels, one.radiance.pixels);
        EXPECT_EQ(one.layers->indirect.pixels, many.layers->indirect.pixels);
        EXPECT_EQ(one.layers->leaf.pixels, many.layers->leaf.pixels);
        EXPECT_EQ(one.layers->depth.pixels, many.layers->depth.pixels);
    }
}

} // namespace
} // namespace kokage::test

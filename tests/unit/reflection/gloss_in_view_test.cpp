#include "reflection/gloss_in_view.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

/// A triangle of a metre at each place, each with a gloss of its own roughness; 0: matt.
struct Triangles {
    PatchScene patches;
    ShadedScene scene;

    Triangles(const std::vector<std::pair<glm::vec3, float>>& list) {
        for (const auto& [place, roughness] : list) {
            const auto first = std::uint32_t(patches.positions.size());
            for (const glm::vec3& corner : {glm::vec3(0.f), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)})
                patches.positions.push_back(place + corner);
            patches.triangles.emplace_back(first, first + 1, first + 2);
            scene.triangle_look.push_back(std::uint32_t(scene.looks.size()));
            SurfaceLook& look = scene.looks.emplace_back();
            look.gloss.normal_reflectance = glm::vec3(roughness > 0 ? 0.04f : 0.f);
            look.gloss.roughness = roughness;
        }
        scene.patches = &patches;
    }
};

CameraFrame looks_along_minus_z() {
    return camera_frame({{0, 0, 0}, {0, 0, -1}}, 64, 48);
}

TEST(GlossInView, OnlyWhatTheCameraMaySeeCounts) {
    const Triangles t({{{0, 0, -5}, 0.4f}, {{0, 0, 5}, 0.1f}, {{40, 0, -5}, 0.9f}, {{0.5f, 0, -6}, 0.6f}});
    const RoughnessBounds seen = roughness_in_view(t.scene, looks_along_minus_z());
    EXPECT_FLOAT_EQ(seen.least, 0.4f);
    EXPECT_FLOAT_EQ(seen.most, 0.6f);
}

TEST(GlossInView, ATriangleThatReachesIntoThePictureCounts) {
    // The picture is 2.06 m wide on either side at 5 m: the first corner is outside of it, the others are inside.
    const Triangles t({{{-2.3f, 0, -5}, 0.4f}});
    EXPECT_FLOAT_EQ(roughness_in_view(t.scene, looks_along_minus_z()).least, 0.4f);
}

TEST(GlossInView, BakesAreSkippedWhereNothingInViewIsGlossy) {
    const Triangles t({{{0, 0, -5}, 0.f}, {{0, 0, 5}, 0.1f}});
    WorkReport report;
    EXPECT_FALSE(lobes_to_bake(t.scene, looks_along_minus_z(), {}, report));
    ASSERT_EQ(report.skips.size(), 1u);
    const auto all = lobes_to_bake(t.scene, looks_along_minus_z(), {.bake_of_matt = false}, report);
    ASSERT_TRUE(all);
    EXPECT_FLOAT_EQ(all->least, 0.25f);
    EXPECT_FLOAT_EQ(all->most, 1);
    EXPECT_EQ(report.skips.size(), 1u);
}

TEST(GlossInView, TheWholeScaleIsBakedIfAsked) {
    const Triangles t({{{0, 0, -5}, 0.4f}});
    WorkReport report;
    const auto part = lobes_to_bake(t.scene, looks_along_minus_z(), {}, report);
    ASSERT_TRUE(part);
    EXPECT_FLOAT_EQ(part->least, 0.4f);
    EXPECT_FLOAT_EQ(part->most, 0.4f);
    const auto all = lobes_to_bake(t.scene, looks_along_minus_z(), {.lobes_out_of_view = false}, report);
    ASSERT_TRUE(all);
    EXPECT_FLOAT_EQ(all->least, 0.25f);
    EXPECT_FLOAT_EQ(all->most, 1);
}

} // namespace
} // namespace kokage

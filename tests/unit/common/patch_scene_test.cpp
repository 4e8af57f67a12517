#include "common/scene/patch_scene.h"
#include "common/services/error.h"
#include "tests/unit/common/scene_builders.h"

#include <functional>
#include <gtest/gtest.h>

namespace kokage {
namespace {

PatchScene two_leaves() {
    PatchScene scene;
    scene.optics = {{glm::vec3(0.5f), glm::vec3(0.4f)}};
    test::add_rectangle(scene, {0, 0, 0}, {2, 0, 0}, {0, 3, 0});
    test::add_rectangle(scene, {5, 0, -1}, {1, 0, 0}, {0, 0, 0.5f});
    return scene;
}

TEST(PatchScene, BoundsHoldTrianglesOnly) {
    PatchScene scene = two_leaves();
    scene.positions.push_back({100, 100, 100}); // used by no triangle
    const Bounds bounds = bounds_of(scene);
    EXPECT_EQ(bounds.low, glm::vec3(0, 0, -1));
    EXPECT_EQ(bounds.high, glm::vec3(6, 3, 0));
    EXPECT_EQ(bounds.centre(), glm::vec3(3, 1.5f, -0.5f));
    EXPECT_EQ(bounds_of(PatchScene{}).diagonal(), 0.f);
}

TEST(PatchScene, AreasOfSolidPatches) {
    const std::vector<double> areas = solid_areas(two_leaves());
    ASSERT_EQ(areas.size(), 2u);
    EXPECT_NEAR(areas[0], 6, 1e-12);
    EXPECT_NEAR(areas[1], 0.5, 1e-12);
}

TEST(PatchScene, HolesAreTakenOutOfAreas) {
    PatchScene scene = two_leaves();
    test::mask_rectangles(scene, test::half_mask());
    EXPECT_NEAR(solid_areas(scene)[0], 3, 0.02);
    EXPECT_NEAR(solid_areas(scene)[1], 0.25, 0.002);

    // Against a plain Monte Carlo count, on a mask whose texels are not aligned with the lattice.
    scene = two_leaves();
    test::mask_rectangles(scene, test::checkered_mask(7));
    for (glm::vec2& uv : scene.uvs)
        uv = uv * 0.83f + glm::vec2(0.31f, -0.47f); // crosses the texture's border: repeats
    Random random(1);
    int solid = 0;
    const int draws = 400000;
    for (int i = 0; i < draws; ++i)
        solid += scene.masks[0].solid(glm::vec2(random.uniform(), random.uniform()) * 0.83f + glm::vec2(0.31f, -0.47f));
    const double expected = 6.0 * solid / draws;
    EXPECT_NEAR(solid_areas(scene)[0], expected, 6 * 0.015);

    scene.masks[0].cutoff = 2; // nothing is solid
    EXPECT_EQ(solid_areas(scene)[0], 0);
}

TEST(PatchScene, ValidSceneIsAccepted) {
    PatchScene scene = two_leaves();
    EXPECT_NO_THROW(validate(scene));
    test::mask_rectangles(scene, test::half_mask());
    EXPECT_NO_THROW(validate(scene));
    EXPECT_NO_THROW(validate(PatchScene{}));
}

TEST(PatchScene, EveryInconsistencyIsNamed) {
    const auto message = [](const std::function<void(PatchScene&)>& spoil) -> std::string {
        PatchScene scene = two_leaves();
        test::mask_rectangles(scene, test::half_mask());
        scene.ground = Ground{};
        spoil(scene);
        try {
            validate(scene);
        } catch (const InputError& error) {
            return error.what();
        }
        return "accepted";
    };
    using S = PatchScene;
    const auto names = [&](const char* part, const std::function<void(S&)>& spoil) {
        EXPECT_NE(message(spoil).find(part), std::string::npos) << message(spoil) << "\nshould name: " << part;
    };
    names("position 4 is not finite", [](S& s) { s.positions[4].y = NAN; });
    names("position 0 is not finite", [](S& s) { s.positions[0].z = -INFINITY; });
    names("triangle 3 names position 99", [](S& s) { s.triangles[3].y = 99; });
    names("triangle 1 names patch 7", [](S& s) { s.triangle_patch[1] = 7; });
    names("holds triangle 1, which says", [](S& s) { s.triangle_patch[1] = 1; });
    names("names alpha mask 3", [](S& s) { s.triangle_mask[2] = 3; });
    names("no texture coordinates", [](S& s) { s.uvs.clear(); });
    names("texture coordinates; give one each", [](S& s) { s.uvs.pop_back(); });
    names("alpha mask 0 has no image", [](S& s) { s.masks[0].alpha = nullptr; });
    names("texture coordinate 2 is not finite", [](S& s) { s.uvs[2].x = NAN; });
    names("patch 1 ends at triangle", [](S& s) { s.patches[1].triangle_count = 9; });
    names("patch 0 names optics 5", [](S& s) { s.patches[0].optics = 5; });
    names("belongs to leaf 2", [](S& s) { s.patches[1].leaf = 2; });
    names("optics 0 has reflectance", [](S& s) { s.optics[0].reflectance.g = 0.7f; });
    names("optics 0 has reflectance", [](S& s) { s.optics[0].reflectance.g = NAN; });
    names("optics 0 has reflectance", [](S& s) { s.optics[0].transmittance.r = -0.1f; });
    names("ground's albedo", [](S& s) { s.ground->albedo.g = 1.5f; });
    names("ground's height", [](S& s) { s.ground->height_m = INFINITY; });
    names("patch numbers; give one each", [](S& s) { s.triangle_patch.pop_back(); });
    names("alpha-mask numbers", [](S& s) { s.triangle_mask.pop_back(); });
}

} // namespace
} // namespace kokage

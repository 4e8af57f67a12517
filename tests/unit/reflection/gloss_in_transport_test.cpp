#include "reflection/gloss_in_transport.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <gtest/gtest.h>

namespace kokage::test {
namespace {

/// One patch, lit from both sides, glossy or not.
struct LitPatch {
    PatchScene patches;
    ShadedScene scene;

    LitPatch(const Optics& optics, float reflectance) {
        patches.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        patches.triangles = {{0, 1, 2}};
        patches.triangle_patch = {0};
        patches.patches.push_back({0, 1, 0, PatchKind::leaf, 0});
        patches.optics = {optics};
        scene = evenly_shaded(patches, glm::vec3(0.f));
        SurfaceLook look;
        look.gloss.normal_reflectance = glm::vec3(reflectance);
        look.gloss.roughness = 0.4f;
        scene.looks = {look};
        scene.triangle_look = {0};
    }
    void light(const Optics& optics, const glm::vec3& above, const glm::vec3& below) {
        scene.indirect_front = {(optics.reflectance * above + optics.transmittance * below) / kPi};
        scene.indirect_back = {(optics.reflectance * below + optics.transmittance * above) / kPi};
    }
};

TEST(GlossInTransport, GivesBackWhatIsScatteredWithoutGloss) {
    const glm::vec3 above(3, 2, 1), below(0.5f, 1, 4);
    for (const Optics& optics : {Optics{glm::vec3(0.25f), glm::vec3(0.1f)}, Optics{glm::vec3(0.4f), glm::vec3(0.f)},
                                 Optics{glm::vec3(0.f), glm::vec3(0.f)}}) {
        LitPatch lit(optics, 0.04f);
        const std::vector<Optics> with_gloss = optics_with_gloss(lit.scene);
        ASSERT_GT(with_gloss[0].reflectance.r, optics.reflectance.r + 0.04f);
        lit.light(optics, above, below);
        const glm::vec3 front = lit.scene.indirect_front[0], back = lit.scene.indirect_back[0];
        lit.light(with_gloss[0], above, below);
        take_gloss_out(with_gloss, lit.scene);
        EXPECT_LT(glm::length(lit.scene.indirect_front[0] - front), 1e-5f) << optics.reflectance.r;
        EXPECT_LT(glm::length(lit.scene.indirect_back[0] - back), 1e-5f);
    }
}

TEST(GlossInTransport, KeepsEnergyAndIsFiniteWhereSidesCantBeToldApart) {
    // Reflectance with gloss = transmittance: the two radiances are equal, whatever the light.
    const glm::vec3 k = mean_gloss_reflectance(glm::vec3(0.04f), 0.4f);
    const Optics optics{glm::vec3(0.3f) - k, glm::vec3(0.3f)};
    LitPatch lit(optics, 0.04f);
    const std::vector<Optics> with_gloss = optics_with_gloss(lit.scene);
    lit.light(optics, glm::vec3(2), glm::vec3(1));
    const glm::vec3 sum = lit.scene.indirect_front[0] + lit.scene.indirect_back[0];
    lit.light(with_gloss[0], glm::vec3(2), glm::vec3(1));
    take_gloss_out(with_gloss, lit.scene);
    EXPECT_LT(glm::length(lit.scene.indirect_front[0] + lit.scene.indirect_back[0] - sum), 1e-5f);
}

TEST(GlossInTransport, LeavesMattPatchesAloneAndNeverGivesMoreThanCame) {
    LitPatch matt({glm::vec3(0.3f), glm::vec3(0.2f)}, 0);
    EXPECT_EQ(optics_with_gloss(matt.scene)[0].reflectance, glm::vec3(0.3f));
    matt.light(matt.patches.optics[0], glm::vec3(2), glm::vec3(1));
    const glm::vec3 before = matt.scene.indirect_front[0];
    take_gloss_out(optics_with_gloss(matt.scene), matt.scene);
    EXPECT_EQ(matt.scene.indirect_front[0], before);
    const LitPatch white({glm::vec3(0.6f), glm::vec3(0.38f)}, 0.9f);
    EXPECT_LE(optics_with_gloss(white.scene)[0].reflectance.r, 0.62f + 1e-6f);
}

} // namespace
} // namespace kokage::test

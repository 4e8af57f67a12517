// What a mirror shows of other surfaces, against path tracing.
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

/// A mirror on the ground, in which the camera sees a glossy panel that stands upright behind it. Neither scatters.
struct PanelInMirror {
    PatchScene patches;
    ShadedScene scene;

    explicit PanelInMirror(const Gloss& gloss) {
        patches.optics.resize(1);
        add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
        add_rectangle(patches, {-1.5f, -1, 3}, {0, 0, -6}, {0, 6, 0});
        for (int face = 0; face < 2; ++face)
            patches.uvs.insert(patches.uvs.end(), {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}});
        scene = evenly_shaded(patches, glm::vec3(0.f));
        scene.looks.resize(2);
        scene.looks[0].gloss.normal_reflectance = glm::vec3(0.9f);
        scene.looks[0].gloss.roughness = 0.03f;
        scene.looks[1].gloss = gloss;
        scene.triangle_look = {0, 0, 1, 1};
    }
    PanelInMirror(const PanelInMirror&) = delete;

    glm::dvec3 shown(const Environment& environment, int samples, bool truth) const {
        const Camera camera = camera_at({3, 3, 0}, {0, 0, 0}, 0.08f);
        const RayQueries queries(patches);
        const auto draw = truth ? render_path_traced : render_picture;
        return mean_of(
            draw(scene, queries, environment, camera, without_ground(12, 12, samples), silent_progress()).radiance);
    }
};

TEST(MetSurfaces, MirrorLightsThatAreWiderThanTheirLobe) {
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(0.5f);
    for (const float roughness : {0.15f, 0.4f, 0.9f}) { // the disc is wide for all but the last
        gloss.roughness = roughness;
        const PanelInMirror scene(gloss);
        Environment light = constant_environment(glm::vec3(0.f));
        light.distant_lights.push_back(disc_light({1, 1, 0}, 0.5f, glm::vec3(1.f)));
        const double truth = scene.shown(light, 400, true).g, fast = scene.shown(light, 100, false).g;
        // Smoother ones than of 0.3 are met as if they were of that.
        EXPECT_NEAR(fast / truth, 1, roughness < 0.3f ? 0.15 : 0.04) << roughness;
    }
}

TEST(MetSurfaces, HaveGlossThatTheirTextureDoesNotColour) {
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(0.4f);
    gloss.roughness = 0.5f;
    for (const bool metal : {false, true}) {
        gloss.tinted_reflectance = metal ? gloss.normal_reflectance : glm::vec3(0.f);
        PanelInMirror scene(gloss);
        const Environment white = constant_environment(glm::vec3(1.f));
        // What the solution knows of the panel's gloss: its mean colour, spread evenly. The floor hides little.
        scene.scene.gloss_front = {glm::vec3(0.f), 0.97f * mean_gloss_reflectance(gloss.normal_reflectance, 0.5f)};
        scene.scene.gloss_back.assign(2, glm::vec3(0.f));
        auto red = std::make_shared<Image>(1, 1, 3);
        red->pixels = {0.9f, 0.3f, 0.3f};
        scene.scene.looks[1].base_color_texture = red;
        scene.scene.looks[1].mean_base_color = glm::vec3(0.5f); // elsewhere it is less red
        const glm::dvec3 truth = scene.shown(white, 400, true), fast = scene.shown(white, 64, false);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(fast[c] / truth[c], 1, 0.06) << metal << " " << c;
        EXPECT_NEAR(truth.r / truth.g, metal ? 3 : 1, metal ? 0.3 : 0.02);
    }
}

} // namespace
} // namespace kokage::test

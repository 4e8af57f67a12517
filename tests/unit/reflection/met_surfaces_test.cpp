// What a mirror shows of other surfaces, against path tracing.
#include "common/environment/lat_long.h"
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
        EXPECT_NEAR(fast / truth, 1, 0.04) << roughness;
    }
}

/// Light from about where the panel mirrors the mirror's view to, and nearly none from elsewhere.
Environment bright_around(const glm::vec3& direction) {
    Environment environment;
    environment.remainder = Image(128, 64, 3);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x)
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] =
                    glm::dot(glm::vec3(pixel_direction(x, y, 128, 64)), glm::normalize(direction)) > 0.97f
                        ? float(c + 1)
                        : 0.05f;
    return environment;
}

TEST(MetSurfaces, MirrorWhatTheyFaceAndNotItsMean) {
    Gloss gloss;
    gloss.normal_reflectance = {0.8f, 0.5f, 0.3f};
    for (const float roughness : {0.02f, 0.1f, 0.25f}) {
        gloss.roughness = roughness;
        PanelInMirror scene(gloss);
        scene.scene.gloss_front.assign(2, glm::vec3(50.f)); // of the solution, which knows no direction
        scene.scene.gloss_back = scene.scene.gloss_front;
        for (const glm::vec3& place : {glm::vec3(1, 1, 0), glm::vec3(-1, 1, 0)}) { // the second behind the panel
            const Environment light = bright_around(place);
            const glm::dvec3 truth = scene.shown(light, 200, true), fast = scene.shown(light, 64, false);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(fast[c], truth[c], 0.04 * truth[c] + 0.006 * double(c + 1)) // the map's lobe is a bit wider
                    << roughness << " " << place.x << " " << c;
        }
    }
}

TEST(MetSurfaces, BetweenMirrorsAndRoughOnesChangeGradually) {
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(0.8f);
    const Environment light = bright_around({1, 1, 0});
    const auto shown = [&](float roughness) {
        gloss.roughness = roughness;
        PanelInMirror scene(gloss);
        scene.scene.gloss_front.assign(2, glm::vec3(0.3f));
        scene.scene.gloss_back = scene.scene.gloss_front;
        return scene.shown(light, 64, false).g;
    };
    const double mirror = shown(0.3f), between = shown(0.4f), rough = shown(0.5f);
    EXPECT_GT(mirror, 1.2 * between);
    EXPECT_GT(between, 1.2 * rough);
}

/// Two mirrors that face each other, seen aslant: their light comes from ever fewer of many reflections.
TEST(MetSurfaces, ShowManyMirrorsInARow) {
    PatchScene patches;
    patches.optics.resize(1);
    add_rectangle(patches, {-1, 0, 3}, {0, 4, 0}, {0, 0, -6});
    add_rectangle(patches, {1, 0, 3}, {0, 0, -6}, {0, 4, 0});
    ShadedScene scene = evenly_shaded(patches, glm::vec3(0.f));
    scene.looks.resize(1);
    scene.looks[0].gloss.normal_reflectance = glm::vec3(0.7f);
    scene.looks[0].gloss.roughness = 0.02f;
    scene.triangle_look.assign(4, 0);
    const RayQueries queries(patches);
    const Environment white = constant_environment(glm::vec3(1.f));
    for (const float height : {2.5f, 1.7f}) { // what is seen leaves after 3 and after 5 reflections
        const Camera camera = camera_at({0.9f, height, 0}, {-1, height + 0.4f, 0}, 0.02f);
        const auto shown = [&](const auto& draw, int samples) {
            return mean_of(
                       draw(scene, queries, white, camera, without_ground(8, 8, samples), silent_progress()).radiance)
                .g;
        };
        const double truth = shown(render_path_traced, 1000), fast = shown(render_picture, 64);
        EXPECT_NEAR(fast / truth, 1, 0.04) << height;
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

// What no line of a light's beams met.
#include "foliage/bundles/drawn_lights.h"
#include "tests/unit/foliage/small_trees.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace bundles;

/// A leaf of 30 x 30 petals of 8 mm, spread over two metres around a point.
void add_loose_flower(PatchScene& scene, const glm::vec3& middle) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < 30; ++i)
        for (int k = 0; k < 30; ++k) {
            // Each lies in a plane of its own.
            const float turn = 0.02f * float(30 * i + k);
            const glm::vec3 corner = middle + glm::vec3(float(i) / 15 - 1, 0, float(k) / 15 - 1),
                            u = 0.008f * glm::vec3(std::cos(0.3f) * std::cos(turn), std::sin(0.3f), std::sin(turn)),
                            v = 0.008f * glm::vec3(-std::sin(turn), 0.1f, std::cos(turn));
            corners.insert(corners.end(), {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v});
        }
    test::add_leaf(scene, corners);
}

TEST(BundlesDrawnLights, PetalsThatNoLineMeetAreAsShadedAsTheirFlower) {
    PatchScene scene;
    scene.optics = {test::realistic_leaf()};
    test::add_rectangle(scene, {-2, 3, -2}, {0, 0, 4}, {4, 0, 0}); // a roof
    add_loose_flower(scene, {0, 1, 0});                            // below it
    add_loose_flower(scene, {8, 1, 0});                            // beside it
    const Facets facets = make_facets(scene);
    Environment environment = constant_environment(glm::vec3(0));
    DistantLight sun;
    sun.direction = {0, 1, 0};
    sun.irradiance = glm::vec3(1);
    environment.distant_lights = {sun};
    BundleEffort effort;
    effort.light_samples = 4096;
    const std::optional<GroundGrid> no_ground;
    DrawnLights lights(scene, facets, no_ground);
    WorkReport report;
    const BeamLight light = lights.light(environment, effort, 0, 1, silent_progress(), report);
    EXPECT_NEAR(light.mean(0).r + light.mean(1).r, 1, 0.01f); // the roof
    EXPECT_LT(light.mean(2).r + light.mean(3).r, 0.01f);      // by the mean of all that lines met: 0.93
    EXPECT_GT(light.mean(4).r + light.mean(5).r, 0.5f);
}

} // namespace
} // namespace kokage

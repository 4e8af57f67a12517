#include "reflection/seen_share.h"
#include "tests/unit/common/scene_builders.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <gtest/gtest.h>

namespace kokage::test {
namespace {

TEST(SeenShare, CountsThePixelsThatAPatchCovers) {
    PatchScene scene;
    scene.optics = {{glm::vec3(0.4f), glm::vec3(0.2f)}};
    add_rectangle(scene, {-0.5f, 0, 0}, {1, 0, 0}, {0, 1, 0}, 0); // faces +Z
    const Camera camera = camera_at({0.3f, 0.4f, 4}, {0.9f, 0.2f, 0}, 0.8f);
    const CameraFrame frame = camera_frame(camera, 400, 300);
    const RayQueries queries(scene);
    int seen = 0;
    for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
            RayHit hit;
            seen += queries.first_hit(frame.position, frame.direction(float(x) + 0.5f, float(y) + 0.5f), 0, 1e9f, hit);
        }
    ASSERT_GT(seen, 3000);
    EXPECT_NEAR(pixels_of_patch(scene, scene.patches[0], true, frame) / seen, 1, 0.02);
    EXPECT_EQ(pixels_of_patch(scene, scene.patches[0], false, frame), 0); // turned away
}

} // namespace
} // namespace kokage::test

// A floor that lies exactly in the ground's plane: it is seen, nowhere the ground in it.
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/picture_scenes.h"

#include <gtest/gtest.h>

namespace kokage::test {
namespace {

constexpr float kHeight = 0.37f;

/// 40 x 40 m of red floor; the camera sees nothing else, at a flat angle.
struct Floor {
    PatchScene patches;
    ShadedScene scene;
    Environment sky = constant_environment(glm::vec3(1.f));
    Camera camera = camera_at({0.1f, kHeight + 1.3f, 0.2f}, {4, kHeight, 3}, 0.3f);

    explicit Floor(bool own_ground) {
        patches.optics = {{glm::vec3(0.6f, 0.1f, 0.1f), glm::vec3(0.f)}};
        add_rectangle(patches, {-20, kHeight, 20}, {40, 0, 0}, {0, 0, -40});
        if (own_ground)
            patches.ground = Ground{kHeight, glm::vec3(0.1f, 0.6f, 0.1f)};
        else
            sky.has_lower_half = false;
        scene = evenly_shaded(patches, glm::vec3(0.6f, 0.1f, 0.1f));
    }
};

TEST(FloorInTheGround, IsSeenEverywhere) {
    for (const bool own_ground : {true, false}) {
        const Floor floor(own_ground);
        const RayQueries queries(floor.patches);
        for (const bool path_traced : {false, true}) {
            for (const int gather_rays : {0, 2}) {
                PictureOptions options = small_picture(40, 30, 8);
                options.layers = true;
                options.gather_rays = gather_rays;
                const Picture picture =
                    path_traced
                        ? render_path_traced(floor.scene, queries, floor.sky, floor.camera, options, silent_progress())
                        : render_picture(floor.scene, queries, floor.sky, floor.camera, options, silent_progress());
                SCOPED_TRACE(testing::Message() << own_ground << path_traced << gather_rays);
                for (int y = 0; y < options.height; ++y)
                    for (int x = 0; x < options.width; ++x) {
                        ASSERT_NEAR(*picture.subject.at(x, y), 1, 1e-5) << x << ' ' << y;
                        ASSERT_NEAR(picture.layers->albedo.at(x, y)[0], 0.6f, 1e-5f) << x << ' ' << y;
                        if (!path_traced) { // nothing but the sky is before it: no noise
                            ASSERT_NEAR(picture.radiance.at(x, y)[0], 0.6f, 0.03f) << x << ' ' << y;
                        }
                    }
            }
        }
    }
}

} // namespace
} // namespace kokage::test

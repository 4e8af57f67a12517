#include "common/environment/analytic_sky.h"
#include "common/services/parallel.h"
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/ball.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

Gloss varnish(float roughness, float reflectance = 0.5f) {
    Gloss gloss;
    gloss.normal_reflectance = glm::vec3(reflectance);
    gloss.roughness = roughness;
    return gloss;
}

/// The middle of the ball: everything seen belongs to it.
Camera close_camera() {
    return camera_at({0, 0, 4}, {0, 0, 0}, 0.2f);
}

TEST(PathTracedPicture, WhiteFurnaceGivesBackWhatDoesNotGetLost) {
    // Under a sky of 1 a convex ball shows its diffuse albedo plus K times the lobe's mass above the horizon, which
    // near its middle is nearly all of it.
    const Ball ball({glm::vec3(0.3f), glm::vec3(0.f)}, varnish(0.2f, 0.25f));
    const RayQueries queries(ball.patches);
    const Environment white = constant_environment(glm::vec3(1.f));
    const Image picture = render_path_traced(ball.scene, queries, white, camera_at({0, 0, 4}, {0, 0, 0}, 0.02f),
                                             small_picture(16, 16, 256), silent_progress())
                              .radiance;
    EXPECT_NEAR(mean_of(picture).x, 0.3 + 0.25, 5e-3);
}

TEST(PathTracedPicture, AgreesWithTheRendererOnAGlossyBall) {
    const Environment gradient = gradient_environment({0.2f, 0.5f, 1.f}, {0.9f, 0.8f, 0.6f}, {0.1f, 0.05f, 0.02f});
    for (const float roughness : {0.25f, 0.5f, 0.9f}) {
        const Ball ball({glm::vec3(0.f), glm::vec3(0.f)}, varnish(roughness));
        const RayQueries queries(ball.patches);
        PictureOptions options = small_picture(24, 24, 64);
        options.ground = PictureGround::none;
        const glm::dvec3 fast =
            mean_of(render_picture(ball.scene, queries, gradient, close_camera(), options, silent_progress()).radiance);
        options.samples = 400;
        const glm::dvec3 truth = mean_of(
            render_path_traced(ball.scene, queries, gradient, close_camera(), options, silent_progress()).radiance);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(fast[c] / truth[c], 1, 0.015) << roughness;
    }
}

TEST(PathTracedPicture, SunsGlintIsTheSameByBothMethods) {
    Environment sun = constant_environment(glm::vec3(0.f));
    sun.distant_lights.push_back(disc_light({0.3f, 0.4f, 1}, 0.02f, glm::vec3(2.f)));
    for (const float roughness : {0.1f, 0.4f}) { // the lobe is narrower than the disc, and wider
        const Ball ball({glm::vec3(0.2f), glm::vec3(0.f)}, varnish(roughness));
        const RayQueries queries(ball.patches);
        PictureOptions options = small_picture(24, 24, 64);
        options.ground = PictureGround::none;
        // Near the glint, which is small.
        const Camera camera =
            camera_at({0, 0, 4}, glm::normalize(glm::normalize(glm::vec3(0.3f, 0.4f, 1)) + glm::vec3(0, 0, 1)), 0.06f);
        const glm::dvec3 fast =
            mean_of(render_picture(ball.scene, queries, sun, camera, options, silent_progress()).radiance);
        options.samples = 400;
        const glm::dvec3 truth =
            mean_of(render_path_traced(ball.scene, queries, sun, camera, options, silent_progress()).radiance);
        EXPECT_NEAR(fast.x / truth.x, 1, 0.02) << roughness;
    }
}

TEST(PathTracedPicture, SameBitsForAnyNumberOfThreads) {
    const Ball ball({glm::vec3(0.5f), glm::vec3(0.f)}, varnish(0.3f));
    const RayQueries queries(ball.patches);
    const Environment white = constant_environment(glm::vec3(1.f));
    const auto draw = [&](int threads) {
        set_thread_count(threads);
        const Image image =
            render_path_traced(ball.scene, queries, white, close_camera(), small_picture(20, 20, 4), silent_progress())
                .radiance;
        set_thread_count(0);
        return image.pixels;
    };
    EXPECT_EQ(draw(1), draw(3));
}

} // namespace
} // namespace kokage::test

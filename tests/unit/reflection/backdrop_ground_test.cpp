// The ground that an image shows takes the scene's shade: by the renderer as by tracing paths, and without light from
// nowhere.
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/ball.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

Environment two_halves(float upper, float lower, int rows = 512) {
    Environment environment = constant_environment(glm::vec3(1.f));
    Image& image = environment.remainder;
    image = Image(2 * rows, rows, 3);
    const auto middle = image.pixels.begin() + std::ptrdiff_t(image.pixels.size() / 2);
    std::fill(image.pixels.begin(), middle, upper);
    std::fill(middle, image.pixels.end(), lower);
    return environment;
}

/// The ground beside the ball's foot.
Camera camera_at_foot() {
    return camera_at({0, 3, 5}, {0, -1, 1.2f}, 0.2f);
}

Image drawn_by_paths(const Ball& ball, const Environment& environment, const Camera& camera, int samples) {
    return render_path_traced(ball.scene, RayQueries(ball.patches), environment, camera, small_picture(16, 16, samples),
                              silent_progress())
        .radiance;
}

Image drawn_fast(const Ball& ball, const Environment& environment, const Camera& camera) {
    return render_picture(ball.scene, RayQueries(ball.patches), environment, camera, small_picture(16, 16, 64),
                          silent_progress())
        .radiance;
}

TEST(BackdropGround, IsAsDarkByTheRendererAsByPaths) {
    const Ball black({glm::vec3(0.f), glm::vec3(0.f)});
    for (const bool sunny : {false, true}) {
        Environment environment = two_halves(1, 0.3f);
        if (sunny)
            environment.distant_lights.push_back(disc_light({0.2f, 0.7f, -1}, 0.1f, glm::vec3(2.f)));
        const double truth = mean_of(drawn_by_paths(black, environment, camera_at_foot(), 600)).x;
        EXPECT_NEAR(mean_of(drawn_fast(black, environment, camera_at_foot())).x / truth, 1, 0.015) << sunny;
        EXPECT_LT(truth, 0.85 * 0.3 * (sunny ? 1.5 : 1)) << "it is in the shade";
    }
}

TEST(BackdropGround, OfAWhiteFurnaceStaysWhite) {
    const Ball white({glm::vec3(1.f), glm::vec3(0.f)});
    const Environment furnace = constant_environment(glm::vec3(1.f));
    EXPECT_NEAR(mean_of(drawn_by_paths(white, furnace, camera_at_foot(), 200)).x, 1, 0.01);
    EXPECT_NEAR(mean_of(drawn_by_paths(white, furnace, camera_at({0, 0, 4}, {0, 0, 0}, 0.2f), 200)).x, 1, 0.01);
}

/// What is brighter than all light from above could make it shines by itself, and does not grow by what it lights.
TEST(BackdropGround, ThatIsBrighterThanItsSkyDoesNotGrow) {
    const Ball white({glm::vec3(0.98f), glm::vec3(0.f)});
    const Image picture = drawn_by_paths(white, two_halves(1, 500), camera_at_foot(), 100);
    for (const float value : picture.pixels)
        EXPECT_TRUE(std::isfinite(value));
    // At most what a white ground would throw back of a white ball's light is added.
    EXPECT_LT(mean_of(picture).x, 2 * 500);
    const Ball black({glm::vec3(0.f), glm::vec3(0.f)});
    const double shaded = mean_of(drawn_by_paths(black, two_halves(1, 500), camera_at_foot(), 100)).x;
    EXPECT_LT(shaded, 500);
    EXPECT_GT(shaded, 0.98 * 500) << "a pixel or two show the ball";
    EXPECT_NEAR(mean_of(drawn_by_paths(white, two_halves(1, 0), camera_at_foot(), 4)).x, 0, 1e-6) << "black stays";
}

/// Nothing says how such a ground was lit, so it stays.
TEST(BackdropGround, UnderABlackSkyIsAsTheImageShowsIt) {
    const Ball black({glm::vec3(0.f), glm::vec3(0.f)});
    const Camera camera = camera_at({0, 3, 5}, {0, -1, 4}, 0.1f);
    for (const int rows : {8, 512}) { // enlarged smoothly, the sky of few rows is not quite black
        const Environment environment = two_halves(0, 0.3f, rows);
        EXPECT_NEAR(mean_of(drawn_by_paths(black, environment, camera, 4)).x, 0.3, 0.02) << rows;
        EXPECT_NEAR(mean_of(drawn_fast(black, environment, camera)).x, 0.3, 0.02) << rows;
    }
}

/// Photographs of rooms have lamps in their lower half; neither does the plane of the ground hide them from gloss, nor
/// does light that falls on the ground change them.
TEST(BackdropGround, LetsLampsBelowTheHorizonBeSeenAndMirrored) {
    const DistantLight lamp = disc_light({0, -0.5f, 1}, 0.4f, glm::vec3(2.f));
    Gloss varnish;
    varnish.normal_reflectance = glm::vec3(0.5f);
    varnish.roughness = 0.15f;
    const Ball ball({glm::vec3(0.f), glm::vec3(0.f)}, varnish);
    for (const bool sunny : {false, true}) {
        Environment environment = two_halves(0.02f, 0.01f);
        environment.distant_lights.push_back(lamp);
        if (sunny)
            environment.distant_lights.push_back(disc_light({0, 1, -0.5f}, 0.05f, glm::vec3(3.f)));
        const Camera camera = camera_at({0, 0, 6}, {0, -0.2f, 0}, 0.1f);
        const double truth = mean_of(drawn_by_paths(ball, environment, camera, 400)).x;
        EXPECT_GT(truth, 0.1);
        EXPECT_NEAR(mean_of(drawn_fast(ball, environment, camera)).x / truth, 1, 0.02) << sunny;
        // From behind the ball, straight at the lamp: its own radiance, and a little of the lit ground.
        const Camera at_lamp = camera_at({0, 0, 1.5f}, {0, -0.5f, 2.5f}, 0.1f);
        const double radiance = 2 / (kPiDouble * std::pow(std::sin(0.4), 2));
        EXPECT_NEAR(mean_of(drawn_by_paths(ball, environment, at_lamp, 16)).x, radiance, 0.05 + 1.5 * sunny);
        EXPECT_NEAR(mean_of(drawn_fast(ball, environment, at_lamp)).x, radiance, 0.05 + 1.5 * sunny);
    }
}

} // namespace
} // namespace kokage::test

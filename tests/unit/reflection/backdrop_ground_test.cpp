// The ground that an image shows takes the scene's shade: by the renderer as by tracing paths, and without light from
// nowhere.
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/ball.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

Environment two_halves(float upper, float lower) {
    Environment environment = gradient_environment(glm::vec3(1.f), glm::vec3(1.f), glm::vec3(1.f));
    Image& image = environment.remainder;
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

TEST(BackdropGround, IsAsDarkByTheRendererAsByPaths) {
    const Ball black({glm::vec3(0.f), glm::vec3(0.f)});
    for (const bool sunny : {false, true}) {
        Environment environment = two_halves(1, 0.3f);
        if (sunny)
            environment.distant_lights.push_back(disc_light({0.2f, 0.7f, -1}, 0.1f, glm::vec3(2.f)));
        const double truth = mean_of(drawn_by_paths(black, environment, camera_at_foot(), 600)).x;
        const Picture fast = render_picture(black.scene, RayQueries(black.patches), environment, camera_at_foot(),
                                            small_picture(16, 16, 64), silent_progress());
        EXPECT_NEAR(mean_of(fast.radiance).x / truth, 1, 0.015) << sunny;
        EXPECT_LT(truth, 0.85 * 0.3 * (sunny ? 1.5 : 1)) << "it is in the shade";
    }
}

TEST(BackdropGround, OfAWhiteFurnaceStaysWhite) {
    const Ball white({glm::vec3(1.f), glm::vec3(0.f)});
    const Environment furnace = constant_environment(glm::vec3(1.f));
    EXPECT_NEAR(mean_of(drawn_by_paths(white, furnace, camera_at_foot(), 200)).x, 1, 0.01);
    EXPECT_NEAR(mean_of(drawn_by_paths(white, furnace, camera_at({0, 0, 4}, {0, 0, 0}, 0.2f), 200)).x, 1, 0.01);
}

/// The next ground on a path would be brighter by 500 again, and so on.
TEST(BackdropGround, ThatIsBrighterThanItsSkyDoesNotLightItself) {
    const Ball white({glm::vec3(0.98f), glm::vec3(0.f)});
    const Image picture = drawn_by_paths(white, two_halves(1, 500), camera_at_foot(), 100);
    for (const float value : picture.pixels) {
        EXPECT_TRUE(std::isfinite(value));
        EXPECT_LT(value, 500 * 500.f) << "at most the ground's own light, thrown back by the ball onto it";
    }
    const Ball black({glm::vec3(0.f), glm::vec3(0.f)});
    EXPECT_LT(mean_of(drawn_by_paths(black, two_halves(1, 500), camera_at_foot(), 100)).x, 500);
    EXPECT_NEAR(mean_of(drawn_by_paths(white, two_halves(1, 0), camera_at_foot(), 4)).x, 0, 1e-6)
        << "black stays black";
}

/// Nothing says how such a ground was lit, so it stays.
TEST(BackdropGround, UnderABlackSkyIsAsTheImageShowsIt) {
    const Environment environment = two_halves(0, 0.3f);
    const Ball black({glm::vec3(0.f), glm::vec3(0.f)});
    EXPECT_NEAR(mean_of(drawn_by_paths(black, environment, camera_at({0, 3, 5}, {0, -1, 4}, 0.1f), 4)).x, 0.3, 0.01);
}

/// Photographs of rooms have lamps in their lower half; the plane of the ground does not hide them from gloss.
TEST(BackdropGround, LetsLampsBelowTheHorizonBeMirrored) {
    Environment environment = constant_environment(glm::vec3(0.f));
    environment.distant_lights.push_back(disc_light({0, -0.5f, 1}, 0.4f, glm::vec3(2.f)));
    Gloss varnish;
    varnish.normal_reflectance = glm::vec3(0.5f);
    varnish.roughness = 0.15f;
    const Ball ball({glm::vec3(0.f), glm::vec3(0.f)}, varnish);
    const Camera camera = camera_at({0, 0, 6}, {0, -0.2f, 0}, 0.1f);
    const double truth = mean_of(drawn_by_paths(ball, environment, camera, 400)).x;
    const Picture fast = render_picture(ball.scene, RayQueries(ball.patches), environment, camera,
                                        small_picture(16, 16, 64), silent_progress());
    EXPECT_GT(truth, 0.1);
    EXPECT_NEAR(mean_of(fast.radiance).x / truth, 1, 0.02);
}

} // namespace
} // namespace kokage::test

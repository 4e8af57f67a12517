// Scenes whose light was solved wrongly, gathered where the camera looks: against path tracing.
#include "common/environment/analytic_sky.h"
#include "common/services/parallel.h"
#include "tests/unit/reflection/ball.h"
#include "tests/unit/reflection/bark_tube.h"
#include "tests/unit/reflection/half_hidden_leaf.h"

#include <gtest/gtest.h>

namespace kokage::test {
namespace {

struct View {
    const ShadedScene& scene;
    const Environment& environment;
    Camera camera;

    Image fast(PictureOptions options, int gather_rays) const {
        options.gather_rays = gather_rays;
        return render_picture(scene, RayQueries(*scene.patches), environment, camera, options, silent_progress())
            .radiance;
    }
    Image truth(PictureOptions options, int samples) const {
        options.samples = samples;
        return render_path_traced(scene, RayQueries(*scene.patches), environment, camera, options, silent_progress())
            .radiance;
    }
};

void expect_near(const glm::dvec3& one, const glm::dvec3& truth, double tolerance, const char* what = "") {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(one[c] / truth[c], 1, tolerance) << what << " " << c;
}

/// A leaf that lets most light through, the left half of either side close to a black cover. Cameras above and below
/// see the right half, lit from both sides.
struct TransmittingLeaf {
    PatchScene patches;
    ShadedScene scene;

    TransmittingLeaf() {
        patches.optics = {{glm::vec3(0.1f), glm::vec3(0.6f, 0.5f, 0.4f)}, {}};
        add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);
        add_rectangle(patches, {-1, 0.1f, 1}, {1, 0, 0}, {0, 0, -2}, 1);
        add_rectangle(patches, {-1, -0.1f, 1}, {1, 0, 0}, {0, 0, -2}, 1);
        scene = evenly_shaded(patches, glm::vec3(0.f));
        scene.indirect_front[0] = scene.indirect_back[0] = glm::vec3(0.2f); // half of it is as good as black
    }
    TransmittingLeaf(const TransmittingLeaf&) = delete;
};

TEST(GatheredScenes, LeavesTransmitWhatIsGatheredBehindThem) {
    const TransmittingLeaf leaf;
    const Environment above_alone = gradient_environment({2, 1, 1}, {2, 1, 1}, {0.1f, 0.3f, 0.1f});
    for (const float side : {1.f, -1.f}) {
        const View view{leaf.scene, above_alone, camera_at({0.5f, 6 * side, 0}, {0.5f, 0, 0}, 0.12f)};
        const glm::dvec3 truth = mean_of(view.truth(without_ground(24, 24, 1), 256)),
                         gathered = mean_of(view.fast(without_ground(24, 24, 4), 16));
        expect_near(gathered, truth, 0.03, side > 0 ? "above" : "below");
        EXPECT_GT(std::abs(mean_of(view.fast(without_ground(24, 24, 4), 0)).r / truth.r - 1), 0.2);
    }
}

TEST(GatheredScenes, WithoutLooksNeedNone) {
    HalfHiddenLeaf leaf;
    leaf.scene.looks.clear();
    leaf.scene.triangle_look.clear();
    expect_near(mean_of(leaf.solved(8).radiance), mean_of(leaf.traced(256)), 0.02);
}

TEST(GatheredScenes, LightFromBelowIsGathered) {
    // Seen from below, under a dark sky over a bright lower half; the ground that the lower half shows lies far below.
    PatchScene patches;
    patches.optics = {{glm::vec3(0.4f), glm::vec3(0.1f)}, {}};
    add_rectangle(patches, {-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0);
    add_rectangle(patches, {-1, -0.1f, 1}, {1, 0, 0}, {0, 0, -2}, 1);
    ShadedScene scene = evenly_shaded(patches, glm::vec3(0.2f));
    scene.indirect_back[0] = glm::vec3(0.7f, 0.2f, 0.3f);
    scene.foot_height = -300.f;
    Environment dark_above = gradient_environment({0.1f, 0.1f, 0.3f}, {0.4f, 0.4f, 0.4f}, {2, 1, 0.5f});
    dark_above.has_lower_half = true;
    const View view{scene, dark_above, camera_at({0.5f, -6, 0}, {0.5f, 0, 0}, 0.12f)};
    const glm::dvec3 truth = mean_of(view.truth(without_ground(24, 24, 1), 256));
    for (const PictureGround ground : {PictureGround::none, PictureGround::automatic}) {
        PictureOptions options = without_ground(24, 24, 4);
        options.ground = ground;
        expect_near(mean_of(view.fast(options, 16)), truth, ground == PictureGround::none ? 0.02 : 0.04);
    }
}

/// A ball, its left half under a black plate, solved as if there were none.
struct BallUnderPlate {
    Ball ball{{glm::vec3(0.5f, 0.4f, 0.3f), glm::vec3(0.f)}, Gloss{}, 12};

    BallUnderPlate() {
        ball.patches.optics.emplace_back();
        add_rectangle(ball.patches, {-3, 1.2f, 3}, {3, 0, 0}, {0, 0, -6}, 1);
        ball.scene.normals.resize(ball.patches.positions.size(), {0, 1, 0});
        ball.scene.looks.emplace_back();
        ball.scene.triangle_look.resize(ball.patches.triangles.size(), 1);
        for (std::vector<glm::vec3>* side : {&ball.scene.indirect_front, &ball.scene.indirect_back,
                                             &ball.scene.radiance_front, &ball.scene.radiance_back})
            *side = {glm::vec3(0.25f, 0.2f, 0.15f), glm::vec3(0.f)};
    }
    View view(const Environment& sky) const { return {ball.scene, sky, camera_at({0, 0, 9}, {0, 0, 0}, 0.17f)}; }
};

TEST(GatheredScenes, SmoothSurfacesGatherAtTheirCorners) {
    const BallUnderPlate scene;
    const Environment sky = gradient_environment({1, 1, 1.5f}, {0.5f, 0.5f, 0.5f}, {0.2f, 0.2f, 0.2f});
    const View view = scene.view(sky);
    const Image truth = view.truth(without_ground(48, 48, 1), 64), gathered = view.fast(without_ground(48, 48, 4), 12);
    for (const int first : {0, 12, 24, 36}) // from under the plate to the open
        expect_near(mean_of_columns(gathered, first, first + 12), mean_of_columns(truth, first, first + 12), 0.05,
                    std::to_string(first).c_str());
    EXPECT_GT(mean_of_columns(truth, 36, 48).g / mean_of_columns(truth, 0, 12).g, 1.5);
}

/// A trunk with relief under a black roof that the solution knows nothing of.
struct TrunkUnderRoof {
    Environment sky = sky_over_dim_ground(0);
    BarkTube tube;

    TrunkUnderRoof() : tube(trunk(), sky, 0.02f) {
        tube.patches.optics.emplace_back();
        add_rectangle(tube.patches, {-3, 1.3f, 3}, {6, 0, 0}, {0, 0, -6}, 1);
        tube.patches.uvs.resize(tube.patches.positions.size());
        tube.scene.normals.resize(tube.patches.positions.size(), {0, 1, 0});
        tube.scene.looks.emplace_back();
        tube.scene.triangle_look.resize(tube.patches.triangles.size(), 1);
        for (std::vector<glm::vec3>* side : {&tube.scene.indirect_front, &tube.scene.indirect_back,
                                             &tube.scene.radiance_front, &tube.scene.radiance_back})
            side->emplace_back(0.f);
    }
    static TubeShape trunk() {
        TubeShape shape = straight_trunk();
        shape.sides = 32;
        shape.rings = 16;
        shape.tiles_around = 6;
        shape.tiles_along = 4;
        return shape;
    }
    View view() const { return {tube.scene, sky, camera_at({0.1f, 0.6f, 0.9f}, {0.05f, 0.5f, 0}, 0.2f)}; }
};

TEST(GatheredScenes, BarkWithReliefGathersAboveIt) {
    const TrunkUnderRoof scene;
    const View view = scene.view();
    const PictureOptions options = without_ground(24, 24, 16);
    const glm::dvec3 truth = mean_of(view.truth(options, 200));
    EXPECT_GT(mean_of(view.fast(options, 0)).g / truth.g, 2);
    expect_near(mean_of(view.fast(options, 16)), truth, 0.04);
}

TEST(GatheredScenes, AreTheSameBitsForAnyNumberOfThreads) {
    const BallUnderPlate ball;
    const TrunkUnderRoof trunk;
    const TransmittingLeaf leaf;
    const Environment sky = gradient_environment({1, 1, 1.5f}, {0.5f, 0.5f, 0.5f}, {0.2f, 0.2f, 0.2f});
    const View views[] = {ball.view(sky), trunk.view(), {leaf.scene, sky, camera_at({0.5f, 6, 0}, {0.5f, 0, 0}, 0.3f)}};
    for (const View& view : views) {
        const auto draw = [&](int threads) {
            set_thread_count(threads);
            const Image image = view.fast(without_ground(70, 70, 4), 3);
            set_thread_count(0);
            return image.pixels;
        };
        EXPECT_EQ(draw(1), draw(4));
    }
}

} // namespace
} // namespace kokage::test

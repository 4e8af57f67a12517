// Relief in pictures: the truth against a displaced mesh, the renderer against the truth, and what must not change.
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/path_traced_picture.h"
#include "tests/unit/reflection/bark_tube.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage::test {
namespace {

TubeShape fine_trunk() {
    TubeShape shape = straight_trunk();
    shape.sides = 64;
    shape.rings = 32;
    shape.tiles_around = 6;
    shape.tiles_along = 4;
    return shape;
}

/// A part of the trunk fills the picture.
Camera camera_at_tube() {
    return camera_at({0.3f, 0.6f, 0.9f}, {0, 0.5f, 0}, 0.2f);
}

Picture fast(const BarkTube& tube, const Environment& environment, const Camera& camera,
             const PictureOptions& options) {
    return render_picture(tube.scene, RayQueries(tube.patches), environment, camera, options, silent_progress());
}

/// Mean difference of pixels over the mean.
double difference(const Image& a, const Image& b) {
    double sum = 0, mean = 0;
    for (std::size_t k = 0; k < a.pixels.size(); ++k) {
        sum += std::abs(double(a.pixels[k]) - double(b.pixels[k]));
        mean += double(b.pixels[k]);
    }
    return sum / mean;
}

bool is_finite(const Image& image) {
    return std::all_of(image.pixels.begin(), image.pixels.end(), [](float x) { return std::isfinite(x) && x >= 0; });
}

class ReliefPictureTruth : public testing::TestWithParam<float> {};

TEST_P(ReliefPictureTruth, AgreesWithADisplacedMeshAndTheRendererWithIt) {
    const Environment environment = sky_over_dim_ground(GetParam());
    const BarkTube tube(fine_trunk(), environment, 0.02f);
    const RayQueries queries(tube.patches);
    const PictureOptions options = without_ground(20, 20, 400);
    const Image truth =
        render_path_traced(tube.scene, queries, environment, camera_at_tube(), options, silent_progress()).radiance;

    const PatchScene mesh = tube.displaced(10);
    const ShadedScene unlit = evenly_shaded(mesh, glm::vec3(0.f));
    const Image twin =
        render_path_traced(unlit, RayQueries(mesh), environment, camera_at_tube(), options, silent_progress()).radiance;
    const Image quick = fast(tube, environment, camera_at_tube(), without_ground(20, 20, 64)).radiance;
    for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_NEAR(mean_of(truth)[c] / mean_of(twin)[c], 1, 0.015);
        EXPECT_NEAR(mean_of(quick)[c] / mean_of(truth)[c], 1, 0.02);
    }
    RecordProperty("truth_against_mesh", std::to_string(difference(truth, twin)));
    RecordProperty("renderer_against_truth", std::to_string(difference(quick, truth)));
    EXPECT_LT(difference(truth, twin), 0.06); // mostly the noise of both
    EXPECT_LT(difference(quick, truth), 0.12);
}

INSTANTIATE_TEST_SUITE_P(SkyAndSun, ReliefPictureTruth, testing::Values(0.f, 3.f));

TEST(ReliefPicture, ReliefBelowAQuarterPixelIsNotMadeAndChangesNoBit) {
    const Environment environment = sky_over_dim_ground(3);
    BarkTube tube(fine_trunk(), environment, 0.02f);
    const Camera far = camera_at({30, 0.6f, 90}, {0, 0.5f, 0}, 0.02f);
    // 0.02 m at 95 m, a pixel of 0.02/20 radians: 0.21 pixels
    const Picture with = fast(tube, environment, far, without_ground(20, 20, 4));
    tube.scene.looks[0].relief = {};
    const Picture without = fast(tube, environment, far, without_ground(20, 20, 4));
    EXPECT_EQ(with.radiance.pixels, without.radiance.pixels);
    const auto skipped = [](const Picture& picture) {
        return std::find_if(picture.report.skips.begin(), picture.report.skips.end(),
                            [](const WorkReport::Skip& skip) { return skip.what == "relief"; });
    };
    ASSERT_NE(skipped(with), with.report.skips.end());
    EXPECT_NE(skipped(with)->why.find("0.21 of a pixel"), std::string::npos) << skipped(with)->why;
    EXPECT_NE(skipped(with)->saved.find("heights"), std::string::npos);
    ASSERT_NE(skipped(without), without.report.skips.end());
    EXPECT_NE(skipped(without)->why.find("no material"), std::string::npos);
}

TEST(ReliefPicture, ThinReliefIsTracedInFullIfAsked) {
    const Environment environment = sky_over_dim_ground(3);
    const BarkTube tube(fine_trunk(), environment, 0.02f);
    const Camera far = camera_at({30, 0.6f, 90}, {0, 0.5f, 0}, 0.02f); // 0.21 pixels
    PictureOptions options = without_ground(20, 20, 16);
    const Picture without = fast(tube, environment, far, options);
    options.skips.thin_relief = false;
    const Picture with = fast(tube, environment, far, options);
    EXPECT_NE(with.radiance.pixels, without.radiance.pixels);
    EXPECT_LT(difference(without.radiance, with.radiance), 0.1); // what is so fine is seen as its mean
    EXPECT_TRUE(std::none_of(with.report.skips.begin(), with.report.skips.end(),
                             [](const WorkReport::Skip& skip) { return skip.what.rfind("relief", 0) == 0; }));
}

TEST(ReliefPicture, ReliefOutOfViewIsNotMade) {
    const Environment environment = sky_over_dim_ground(3);
    const BarkTube tube(fine_trunk(), environment, 0.02f);
    const Picture picture =
        fast(tube, environment, camera_at({0, 0.5f, 2}, {0, 0.5f, 4}, 0.5f), without_ground(8, 8, 1));
    ASSERT_FALSE(picture.report.skips.empty());
    EXPECT_TRUE(std::any_of(picture.report.skips.begin(), picture.report.skips.end(), [](const WorkReport::Skip& skip) {
        return skip.what == "relief" && skip.why.find("in view") != std::string::npos;
    }));
}

TEST(ReliefPicture, EvenHeightsLookLikeTheMesh) {
    const Environment environment = sky_over_dim_ground(3);
    BarkTube tube(fine_trunk(), environment, 0.02f);
    std::fill(tube.field->depths.begin(), tube.field->depths.end(), 0.f);
    const Image even = fast(tube, environment, camera_at_tube(), without_ground(20, 20, 16)).radiance;
    tube.scene.looks[0].relief = {};
    const Image mesh = fast(tube, environment, camera_at_tube(), without_ground(20, 20, 16)).radiance;
    EXPECT_LT(difference(even, mesh), 1e-3);
}

TEST(ReliefPicture, FadesOutWithoutAStep) {
    // From just above a quarter of a pixel of depth on, pictures must differ from those without relief by little.
    const Environment environment = sky_over_dim_ground(3);
    BarkTube tube(fine_trunk(), environment, 0.02f);
    const float pixel = 0.2f / 16, distance = 0.02f / (0.275f * pixel); // strength 0.7 %
    const Camera camera = camera_at({0, 0.5f, distance + 0.2f}, {0, 0.5f, 0}, 0.2f);
    const Image with = fast(tube, environment, camera, without_ground(16, 16, 64)).radiance;
    tube.scene.looks[0].relief = {};
    const Image without = fast(tube, environment, camera, without_ground(16, 16, 64)).radiance;
    EXPECT_NE(with.pixels, without.pixels);
    EXPECT_LT(difference(with, without), 0.01);
}

TEST(ReliefPicture, SameBitsForAnyNumberOfThreads) {
    const Environment environment = sky_over_dim_ground(3);
    const BarkTube tube(fine_trunk(), environment, 0.02f);
    const RayQueries queries(tube.patches);
    const auto draw = [&](int threads) {
        set_thread_count(threads);
        const PictureOptions options = without_ground(24, 24, 3);
        std::vector<float> pixels =
            render_picture(tube.scene, queries, environment, camera_at_tube(), options, silent_progress())
                .radiance.pixels;
        const std::vector<float> truth =
            render_path_traced(tube.scene, queries, environment, camera_at_tube(), options, silent_progress())
                .radiance.pixels;
        set_thread_count(0);
        pixels.insert(pixels.end(), truth.begin(), truth.end());
        return pixels;
    };
    EXPECT_EQ(draw(1), draw(3));
}

TEST(ReliefPicture, AnyDepthIsFinite) {
    const Environment environment = sky_over_dim_ground(3);
    for (const float depth : {0.f, 1e-9f, 0.5f, 100.f, 1e30f}) {
        const BarkTube tube(bent_branch(), environment, depth);
        const Camera camera = camera_at({0.3f, 0.3f, 1.5f}, {0.2f, 0.3f, 0}, 0.5f);
        const Picture picture = fast(tube, environment, camera, without_ground(24, 24, 2));
        EXPECT_TRUE(is_finite(picture.radiance)) << depth;
        const RayQueries queries(tube.patches);
        EXPECT_TRUE(is_finite(
            render_path_traced(tube.scene, queries, environment, camera, without_ground(24, 24, 2), silent_progress())
                .radiance))
            << depth;
    }
}

TEST(ReliefPicture, WhatStandsInFrontOfReliefIsSeen) {
    const Environment environment = sky_over_dim_ground(0);
    BarkTube tube(fine_trunk(), environment, 0.02f);
    // A black card between the camera and the lower half of what it sees.
    const auto first = std::uint32_t(tube.patches.positions.size());
    for (const glm::vec3 corner :
         {glm::vec3(-1, -1, 0.4f), glm::vec3(1, -1, 0.4f), glm::vec3(1, 0.5f, 0.4f), glm::vec3(-1, 0.5f, 0.4f)}) {
        tube.patches.positions.push_back(corner);
        tube.patches.uvs.emplace_back(0.f);
        tube.scene.normals.emplace_back(0, 0, 1);
    }
    tube.patches.patches.push_back({std::uint32_t(tube.patches.triangles.size()), 2, 0, PatchKind::bark, 0});
    for (const glm::uvec3 corners : {glm::uvec3(0, 1, 2), glm::uvec3(0, 2, 3)}) {
        tube.patches.triangles.push_back(corners + first);
        tube.patches.triangle_patch.push_back(std::uint32_t(tube.patches.patches.size() - 1));
        tube.scene.triangle_look.push_back(1);
    }
    tube.scene.looks.push_back(SurfaceLook{});
    for (std::vector<glm::vec3>* values :
         {&tube.scene.indirect_front, &tube.scene.indirect_back, &tube.scene.radiance_front, &tube.scene.radiance_back})
        values->emplace_back(0.f);
    const Image seen =
        fast(tube, environment, camera_at({0, 0.5f, 1}, {0, 0.5f, 0}, 0.2f), without_ground(16, 16, 4)).radiance;
    for (int x = 0; x < 16; ++x) {
        EXPECT_EQ(seen.at(x, 12)[0], 0) << x;
        EXPECT_GT(seen.at(x, 3)[0], 0) << x;
    }
}

TEST(ReliefPicture, BadReliefIsRefused) {
    const Environment environment = sky_over_dim_ground(0);
    BarkTube tube(fine_trunk(), environment, 0.02f);
    const auto draw = [&] { fast(tube, environment, camera_at_tube(), without_ground(4, 4, 1)); };
    tube.scene.looks[0].relief.depth_m = -1;
    EXPECT_THROW(draw(), InputError);
    tube.scene.looks[0].relief.depth_m = std::nanf("");
    EXPECT_THROW(draw(), InputError);
    tube.scene.looks[0].relief.depth_m = 0.02f;
    tube.scene.looks[0].relief.heights = std::make_shared<HeightField>();
    EXPECT_THROW(draw(), InputError);
    tube.scene.looks[0].relief.heights = tube.field;
    tube.patches.uvs.clear();
    EXPECT_THROW(draw(), InputError);
}

} // namespace
} // namespace kokage::test

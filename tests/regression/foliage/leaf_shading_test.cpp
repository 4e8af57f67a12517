// How far the shading of a fixed crown is from the truth, by each method that uses light maps. Stored figures, each
// explained: a change means that a method shades differently: look why before storing another.
#include "tests/unit/foliage/shade_small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

const test::JudgedCrown& judged() {
    static const test::JudgedCrown crown(512);
    return crown;
}

Accuracy judge(Method method, GatherRule gather = GatherRule::cosine, int directions = 0) {
    ShadingOptions options;
    options.method = method;
    options.gather = gather;
    options.effort = directions;
    const PatchScene& scene = judged().crown.scene;
    const Solution solution = test::shade(judged().crown, test::sky_and_sun(), options);
    return accuracy(leaf_side_radiance(scene, solution.radiance), judged().reference.sides, solid_areas(scene));
}

TEST(LeafShading, ReferenceIsQuietEnoughToJudge) {
    EXPECT_LT(judged().reference.noise, 0.025);
}

// One mean of all maps, no cosine, no shadow of its own: most leaves get about the same light, sunlit or not.
TEST(LeafShading, PaperIsFarFromTheTruth) {
    const Accuracy paper = judge(Method::paper);
    EXPECT_NEAR(paper.mre, 1.27, 0.05);
    EXPECT_NEAR(paper.bias, 0.05, 0.03);
}

// First light is exact but for its noise, which 256 directions make small; what is left is the maps' blur of bounced
// light.
TEST(LeafShading, LightMapsComeNearIt) {
    const Accuracy cosine = judge(Method::light_maps, GatherRule::cosine, 256);
    EXPECT_NEAR(cosine.mre, 0.068, 0.01);
    EXPECT_NEAR(cosine.bias, -0.005, 0.02);
    const Accuracy rule = judge(Method::light_maps, GatherRule::rule, 256);
    EXPECT_NEAR(rule.mre, 0.090, 0.01);
    EXPECT_LT(cosine.mre, rule.mre) << "why the cosine is the default";
}

// In a small crown of bright leaves the noise of the default's 64 directions drowns in that blur.
TEST(LeafShading, LightMapsByDefaultAreAboutAsNear) {
    EXPECT_NEAR(judge(Method::light_maps).mre, 0.069, 0.01);
}

} // namespace
} // namespace kokage

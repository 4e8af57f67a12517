// How far the shading of a fixed crown is from the truth, by each method that uses light maps. Stored figures, each
// explained: a change means that a method shades differently: look why before storing another.
#include "foliage/accuracy.h"
#include "foliage/light_maps.h"
#include "foliage/paper.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

class LeafShading : public testing::Test {
  protected:
    static constexpr std::uint32_t kLeaves = 1000;

    static void SetUpTestSuite() {
        crown = new test::SmallTree(test::ball_on_a_skeleton(kLeaves, 3, test::bright_leaf()));
        reference =
            new PathTracedReference(path_trace_reference(crown->scene, test::sky_and_sun(), 512, 1, silent_progress()));
    }
    static void TearDownTestSuite() {
        delete reference;
        delete crown;
    }

    static Accuracy judge(ShadingOptions options) {
        const auto transport = options.method == Method::paper
                                   ? make_paper_transport(crown->scene, crown->tree, options, silent_progress())
                                   : make_light_maps_transport(crown->scene, crown->tree, options, silent_progress());
        const Solution solution = transport->solve(test::sky_and_sun(), silent_progress());
        return accuracy(leaf_side_radiance(crown->scene, solution.radiance), reference->sides,
                        solid_areas(crown->scene));
    }

    static Accuracy judge(Method method, GatherRule gather = GatherRule::cosine, int directions = 0) {
        ShadingOptions options;
        options.method = method;
        options.gather = gather;
        options.effort = directions;
        return judge(options);
    }

    static test::SmallTree* crown;
    static PathTracedReference* reference;
};
test::SmallTree* LeafShading::crown = nullptr;
PathTracedReference* LeafShading::reference = nullptr;

TEST_F(LeafShading, ReferenceIsQuietEnoughToJudge) {
    EXPECT_LT(reference->noise, 0.025);
}

// One mean of all maps, no cosine, no shadow of its own: most leaves get about the same light, sunlit or not.
TEST_F(LeafShading, PaperIsFarFromTheTruth) {
    const Accuracy paper = judge(Method::paper);
    EXPECT_NEAR(paper.mre, 1.27, 0.05);
    EXPECT_NEAR(paper.bias, 0.05, 0.03);
}

// First light is exact but for its noise, which 256 directions make small; what is left is the maps' blur of bounced
// light.
TEST_F(LeafShading, LightMapsComeNearIt) {
    const Accuracy cosine = judge(Method::light_maps, GatherRule::cosine, 256);
    EXPECT_NEAR(cosine.mre, 0.068, 0.01);
    EXPECT_NEAR(cosine.bias, -0.005, 0.02);
    const Accuracy rule = judge(Method::light_maps, GatherRule::rule, 256);
    EXPECT_NEAR(rule.mre, 0.090, 0.01);
    EXPECT_LT(cosine.mre, rule.mre) << "why the cosine is the default";
}

// In a small crown of bright leaves the noise of the default's 64 directions drowns in that blur.
TEST_F(LeafShading, LightMapsByDefaultAreAboutAsNear) {
    EXPECT_NEAR(judge(Method::light_maps).mre, 0.069, 0.01);
}

} // namespace
} // namespace kokage

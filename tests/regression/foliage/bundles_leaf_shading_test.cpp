// How far the shading by `bundles` of fixed trees is from the truth. Stored figures, each explained: a change means
// that the method shades differently: look why before storing another.
#include "tests/unit/foliage/shade_small_trees.h"
#include "trees/growth.h"
#include "trees/patches.h"

#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

struct Judged {
    Accuracy accuracy;
    double estimated = 0;
};

Judged judge(const PatchScene& scene, const Tree& tree, const PathTracedReference& truth,
             const ShadingOptions& options) {
    const Solution solution =
        make_transport(scene, tree, options, silent_progress())->solve(test::sky_and_sun(), silent_progress());
    std::vector<double> areas = solid_areas(scene);
    areas.resize(scene.leaf_count); // a patch a leaf, then bark
    return {accuracy(leaf_side_radiance(scene, solution.radiance), truth.sides, areas), *solution.estimated_error};
}

/// The estimate is within 1.5 of the error without the reference's noise.
void expect_honest(const Judged& judged, const PathTracedReference& truth) {
    const double mre = judged.accuracy.mre, error = std::sqrt(std::max(mre * mre - truth.noise * truth.noise, 0.0));
    EXPECT_GT(judged.estimated, error / 1.5);
    EXPECT_LT(judged.estimated, error * 1.5);
}

const test::JudgedCrown& ball() {
    static const test::JudgedCrown crown(1024);
    return crown;
}

Judged judge_ball(const ShadingOptions& options) {
    return judge(ball().crown.scene, ball().crown.tree, ball().reference, options);
}

Judged judge_ball(int directions, std::uint64_t seed = 1) {
    ShadingOptions options;
    options.effort = directions;
    options.seed = seed;
    return judge_ball(options);
}

TEST(BundlesLeafShading, ReferenceIsQuietEnoughToJudge) {
    EXPECT_LT(ball().reference.noise, 0.012);
}

// Lines are samples of the directions: four times as many halve the error, down to what one radiance a leaf side and
// the reference's own noise cost.
TEST(BundlesLeafShading, ErrorHalvesWithFourTimesTheDirections) {
    const Judged few = judge_ball(20), some = judge_ball(80), many = judge_ball(320);
    EXPECT_NEAR(few.accuracy.mre, 0.040, 0.006);
    EXPECT_NEAR(some.accuracy.mre, 0.0235, 0.004);
    EXPECT_NEAR(many.accuracy.mre, 0.0162, 0.003); // the reference's noise of 1.0 % is in it
    for (const Judged& judged : {few, some, many})
        expect_honest(judged, ball().reference);
    EXPECT_NEAR(many.accuracy.bias, 0, 0.005);
}

// The same for other seeds: the figures above are no luck.
TEST(BundlesLeafShading, SeedsAgree) {
    for (std::uint64_t seed : {2u, 3u, 4u}) {
        const Judged judged = judge_ball(40, seed);
        EXPECT_NEAR(judged.accuracy.mre, 0.0285, 0.004);
        expect_honest(judged, ball().reference);
        EXPECT_NEAR(judged.accuracy.bias, 0, 0.01);
    }
}

TEST(BundlesLeafShading, KeepsTheErrorThatWasAskedFor) {
    for (double error : {0.1, 0.05, 0.025}) {
        ShadingOptions options;
        options.error = error;
        const Judged judged = judge_ball(options);
        EXPECT_LT(judged.accuracy.mre, 1.2 * error);
        EXPECT_LT(judged.estimated, 1.2 * error);
    }
}

// A grown oak of shoots, twigs and bark: leaves stand in each other's way at their stalks, and reach into wood.
TEST(BundlesLeafShading, AGrownTreeWithBark) {
    GrowthParameters parameters = oak_parameters();
    parameters.leaves = 1200;
    parameters.young_below = 0; // an old tree's crowded shoots
    const Tree oak = grow(parameters);
    PatchOptions patch_options;
    patch_options.ground = Ground{};
    const PatchScene scene = make_patches(oak, patch_options);
    const PathTracedReference truth = path_trace_reference(scene, test::sky_and_sun(), 512, 1, silent_progress());
    ShadingOptions options;
    options.effort = 160;
    const Judged judged = judge(scene, oak, truth, options);
    // 2.5 % of it is the reference's noise, the rest (4 %) more than the halves of the lines can show: light is uneven
    // over a leaf whose stalk sits in the shade of its shoot, and one radiance a side can't say so. Paths show it.
    EXPECT_NEAR(judged.accuracy.mre, 0.047, 0.006);
    expect_honest(judged, truth); // 0.027 from the halves alone
    EXPECT_NEAR(judged.accuracy.bias, 0, 0.01);
}

} // namespace
} // namespace kokage

// The error that no number of lines mends: how it is measured, and what is done about it.
#include "common/services/error.h"
#include "foliage/accuracy.h"
#include "foliage/bundles/bundles.h"
#include "foliage/bundles/error_by_paths.h"
#include "foliage/bundles/steps.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/small_trees.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <set>

namespace kokage {
namespace {

using namespace bundles;

double normal_number(Random& random) {
    return std::sqrt(-2 * std::log(1 - random.uniform_double())) * std::cos(2 * kPiDouble * random.uniform_double());
}

/// Leaf sides of which everything is known.
struct MadeUp {
    JudgedSides judged;
    TracedSides traced;
    double error = 0;
};

/// `off`, `noise`, `shown`: relative standard deviations of the solution, of each half of the paths, and of what the
/// lines show. Sides are the darker the more wrong and noisy.
MadeUp make_up(double off, double noise, double shown, std::uint64_t seed) {
    constexpr std::uint32_t kLeaves = 1000;
    MadeUp result;
    Random random(seed);
    for (std::uint32_t side = 0; side < 2 * kLeaves; ++side) {
        const double brightness = std::exp2(4 * random.uniform_double() - 2), darkness = 1 / std::sqrt(brightness);
        const bool traced = side / 2 % 5 == 0;
        if (traced && side % 2 == 0)
            result.traced.leaves.push_back(side / 2);
        const double wrong = off * darkness * normal_number(random), half = shown * darkness * normal_number(random),
                     first = noise * darkness * normal_number(random),
                     second = noise * darkness * normal_number(random);
        result.judged.radiance.emplace_back(float(brightness * (1 + wrong)));
        result.judged.half_differences.emplace_back(float(brightness * half));
        result.error += std::abs(wrong) / (2 * kLeaves);
        if (traced) {
            result.traced.first.emplace_back(float(brightness * (1 + first)));
            result.traced.second.emplace_back(float(brightness * (1 + second)));
        }
    }
    return result;
}

TEST(BundlesErrorByPaths, IsFoundBeneathTheNoise) {
    for (const auto& [off, noise, shown] : {std::tuple(0.05, 0.02, 0.05), {0.05, 0.1, 0.01}, {0.1, 0.2, 0.05}})
        for (std::uint64_t seed : {1u, 2u, 3u}) {
            SCOPED_TRACE(testing::Message() << off << ' ' << noise << ' ' << shown << ' ' << seed);
            const MadeUp made = make_up(off, noise, shown, seed);
            const MeasuredError found = error_beneath_noise(made.judged, made.traced);
            EXPECT_NEAR(found.error, made.error, std::max(0.15, 2.5 * found.uncertainty) * made.error);
            EXPECT_LT(found.uncertainty, 0.35);
        }
}

TEST(BundlesErrorByPaths, KnowsWhenItDoesNotKnow) {
    const MadeUp made = make_up(0.003, 0.5, 0.01, 1);
    EXPECT_GT(error_beneath_noise(made.judged, made.traced).uncertainty, 0.5);
}

TEST(BundlesErrorByPaths, LeavesOfAllSizesAreMet) {
    std::vector<double> areas(1000);
    for (std::size_t i = 0; i < areas.size(); ++i)
        areas[i] = i % 10 == 3 ? 0.001 : 1; // a tenth is tiny
    const std::vector<std::uint32_t> leaves = sample_leaves(areas, 100, 7);
    EXPECT_EQ(std::set<std::uint32_t>(leaves.begin(), leaves.end()).size(), 100u);
    EXPECT_TRUE(std::is_sorted(leaves.begin(), leaves.end()));
    EXPECT_EQ(std::count_if(leaves.begin(), leaves.end(), [](std::uint32_t leaf) { return leaf % 10 == 3; }), 10);
    EXPECT_NE(leaves, sample_leaves(areas, 100, 8));
    EXPECT_EQ(sample_leaves(areas, 1000, 7).size(), 1000u);
    EXPECT_TRUE(sample_leaves({}, 10, 7).empty());
}

/// Small leaves stand on a large card, half of which lies in the shade of a dark roof: one radiance for the whole card
/// is wrong for all of them.
test::SmallTree leaves_on_a_half_lit_card() {
    test::SmallTree result;
    result.scene.optics = {{glm::vec3(0.7f), glm::vec3(0.1f)}, {glm::vec3(0.01f), glm::vec3(0)}};
    test::add_rectangle(result.scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0});
    test::add_rectangle(result.scene, {0, 3, -1}, {0, 0, 2}, {1, 0, 0}, 1);
    Random random(5);
    for (int i = 0; i < 30; ++i) {
        const glm::vec3 foot(random.uniform(-0.8f, 0.8f), 0.05f, random.uniform(-0.8f, 0.8f));
        const float turn = random.uniform(0, kPi);
        test::add_rectangle(result.scene, foot, 0.2f * glm::vec3(std::cos(turn), 0, std::sin(turn)), {0, 0.1f, 0});
    }
    result.tree.leaves.resize(result.scene.leaf_count);
    return result;
}

Environment sun_overhead() {
    Environment environment = constant_environment(glm::vec3(0.1f));
    DistantLight sun;
    sun.direction = {0, 1, 0};
    sun.half_angle = 0.0047f;
    sun.irradiance = glm::vec3(5);
    environment.distant_lights.push_back(sun);
    return environment;
}

double true_error(const test::SmallTree& small, const Environment& environment, const Solution& solution) {
    const PathTracedReference truth = path_trace_reference(small.scene, environment, 2048, 9, silent_progress());
    const double mre =
        accuracy(leaf_side_radiance(small.scene, solution.radiance), truth.sides, solid_areas(small.scene)).mre;
    return std::sqrt(std::max(mre * mre - truth.noise * truth.noise, 0.0));
}

bool says(const Solution& solution, const char* text) {
    return std::any_of(solution.report.warnings.begin(), solution.report.warnings.end(),
                       [&](const std::string& warning) { return warning.find(text) != std::string::npos; });
}

TEST(BundlesModelError, LightThatIsUnevenOverALeafIsSeen) {
    const test::SmallTree small = leaves_on_a_half_lit_card();
    const Environment environment = sun_overhead();
    ShadingOptions options;
    options.effort = 640;
    const auto transport = make_transport(small.scene, small.tree, options, silent_progress());
    const Solution solution = transport->solve(environment, silent_progress());
    const double error = true_error(small, environment, solution);
    EXPECT_GT(error, 0.5);
    EXPECT_GT(*solution.estimated_error, error / 1.5);
    EXPECT_LT(*solution.estimated_error, error * 1.5);

    // Another light: another error. Evenly lit, a card has one radiance.
    Environment even = environment;
    even.distant_lights.clear();
    const Solution relit = transport->solve(even, silent_progress());
    const double relit_error = true_error(small, even, relit);
    EXPECT_LT(relit_error, 0.5 * error);
    EXPECT_GT(*relit.estimated_error, relit_error / 1.5);
    EXPECT_LT(*relit.estimated_error, relit_error * 1.5);
}

std::ptrdiff_t checks(const Solution& solution) {
    return std::count_if(solution.report.stages.begin(), solution.report.stages.end(),
                         [](const WorkReport::Stage& stage) { return stage.name == "check by paths"; });
}

TEST(BundlesModelError, IsMeasuredAgainUnderAnotherSkyOrLamp) {
    const test::SmallTree small = leaves_on_a_half_lit_card();
    ShadingOptions options;
    options.effort = 640;
    const Environment sun = sun_overhead();
    Environment weak = sun, stronger = sun, above = sun, brighter = sun;
    weak.distant_lights[0].irradiance *= 1e-4f;
    stronger.distant_lights[0].irradiance *= 1.1f;
    for (float& value : brighter.remainder.pixels)
        value *= 3;
    brighter.distant_lights[0].irradiance *= 3;
    above = weak;
    above.remainder = Image(8, 4, 3);
    std::fill(above.remainder.at(0, 0), above.remainder.at(0, 0) + 3 * 8, 1.f); // only near the zenith
    const auto transport = make_transport(small.scene, small.tree, options, silent_progress());
    auto relit = [&](const Environment& environment) { return transport->solve(environment, silent_progress()); };
    const double even = *relit(weak).estimated_error;
    const Solution sunny = relit(sun), zenith = relit(above);
    EXPECT_EQ(checks(sunny), 1);
    EXPECT_EQ(checks(zenith), 1);
    const double fresh = *make_transport(small.scene, small.tree, options, silent_progress())
                              ->solve(sun, silent_progress())
                              .estimated_error;
    EXPECT_NEAR(*sunny.estimated_error, fresh, 0.2 * fresh);
    EXPECT_LT(even, 0.5 * fresh) << "or this test would show nothing";
    EXPECT_EQ(checks(relit(sun)), 1);
    EXPECT_EQ(checks(relit(sun)), 0);
    EXPECT_EQ(checks(relit(stronger)), 0) << "much the same light";
    EXPECT_EQ(checks(relit(brighter)), 0) << "the same light, brighter";
}

TEST(BundlesModelError, IsLeftToThoseWhoGatherLightThemselves) {
    const test::SmallTree small = leaves_on_a_half_lit_card();
    ShadingOptions options;
    options.error = 0.2;
    const auto solve = [&] {
        return make_transport(small.scene, small.tree, options, silent_progress())
            ->solve(sun_overhead(), silent_progress());
    };
    const auto skips = [](const Solution& solution) {
        return std::count_if(solution.report.skips.begin(), solution.report.skips.end(),
                             [](const auto& skip) { return skip.what == "check of the leaves' light by paths"; });
    };
    const Solution checked = solve();
    EXPECT_GT(checks(checked), 0);
    EXPECT_EQ(checked.method_instead, "path-traced");
    EXPECT_EQ(skips(checked), 0);
    options.check_by_paths = false;
    const Solution unchecked = solve();
    EXPECT_EQ(checks(unchecked), 0);
    EXPECT_EQ(unchecked.method_instead, "");
    EXPECT_EQ(skips(unchecked), 1);
    EXPECT_LT(*unchecked.estimated_error, 1.05 * options.error); // of the lines
    EXPECT_TRUE(unchecked.report.warnings.empty());
}

TEST(BundlesModelError, ResultsAreTakenAfterASecondLook) {
    const test::SmallTree small = leaves_on_a_half_lit_card();
    ShadingOptions options;
    options.error = 2;
    const auto transport = make_transport(small.scene, small.tree, options, silent_progress());
    EXPECT_EQ(checks(transport->solve(sun_overhead(), silent_progress())), 2);
    EXPECT_EQ(checks(transport->solve(sun_overhead(), silent_progress())), 0);
    options.effort = 40; // nothing is decided by it
    EXPECT_EQ(checks(make_transport(small.scene, small.tree, options, silent_progress())
                         ->solve(sun_overhead(), silent_progress())),
              1);
}

TEST(BundlesErrorByPaths, ASecondMeasurementIsPutTogetherWithTheFirst) {
    const test::SmallTree small = test::ball_on_a_skeleton(1000, 2, test::realistic_leaf());
    const Environment environment = test::sky_and_sun();
    const PathTracedReference truth = path_trace_reference(small.scene, environment, 256, 1, silent_progress());
    JudgedSides judged{truth.sides, {}};
    Random random(3);
    for (glm::vec3& side : judged.radiance) {
        side *= 1 + 0.2f * float(normal_number(random));
        judged.half_differences.push_back(0.1f * side);
    }
    ErrorByPaths paths(small.scene);
    TracedSides traced;
    auto measure = [&](std::uint64_t seed) {
        return paths.measure(judged, environment, small.scene.optics, 0, seed, traced, silent_progress());
    };
    measure(1);
    const TracedSides first = traced;
    const MeasuredError both = measure(2);
    ASSERT_GT(traced.leaves.size(), 3 * first.leaves.size() / 2);
    EXPECT_TRUE(std::equal(first.first.begin(), first.first.end(), traced.first.begin()));
    EXPECT_GE(traced.paths_a_side, first.paths_a_side);
    EXPECT_NE(std::vector(traced.leaves.begin() + std::ptrdiff_t(first.leaves.size()), traced.leaves.end()),
              first.leaves);
    EXPECT_EQ(both.error, error_beneath_noise(judged, traced).error);
    EXPECT_LE(both.paths, 200000u);
    const double error =
        accuracy(judged.radiance, truth.sides, solid_areas(small.scene)).mre; // much more than the noise of the truth
    EXPECT_NEAR(both.error, error, 0.2 * error);
}

TEST(BundlesModelError, WhatCanNotBeReachedIsTracedByPathsAndSaid) {
    const test::SmallTree small = leaves_on_a_half_lit_card(); // it has no tree to divide
    const Environment environment = sun_overhead();
    ShadingOptions options;
    options.error = 0.05;
    const Solution solution =
        make_transport(small.scene, small.tree, options, silent_progress())->solve(environment, silent_progress());
    EXPECT_TRUE(says(solution, "paths were traced"));
    EXPECT_LT(true_error(small, environment, solution), 1.5 * options.error);
    EXPECT_LT(*solution.estimated_error, 1.1 * options.error);

    options.error = 2; // within reach: one radiance for the card is wrong by 100 %
    EXPECT_FALSE(
        says(make_transport(small.scene, small.tree, options, silent_progress())->solve(environment, silent_progress()),
             "paths were traced"));
}

TEST(BundlesModelError, PathsInsteadOfBundlesGiveHostsTheSameThings) {
    class Stages : public Progress {
      public:
        void begin(std::string_view stage, std::size_t) override { all += std::string(stage) + "; "; }
        std::string all;
    };
    const test::SmallTree small = test::ball_on_a_skeleton(60, 3, test::realistic_leaf());
    ShadingOptions options;
    options.error = 0.05;
    options.for_hosts = true;
    auto solve = [&](Progress& progress) {
        return make_transport(small.scene, small.tree, options, progress)->solve(test::sky_and_sun(), progress);
    };
    const Solution bundles = solve(silent_progress());
    ASSERT_FALSE(says(bundles, "paths were traced"));
    options.error = 0.006;
    Stages stages;
    const Solution paths = solve(stages);
    ASSERT_TRUE(says(paths, "paths were traced"));
    EXPECT_NE(stages.all.find("instead of bundles"), std::string::npos) << stages.all;
    EXPECT_EQ(paths.bent_normal.size(), bundles.bent_normal.size());
    ASSERT_GT(bundles.light_maps.size(), 0u);
    EXPECT_EQ(paths.light_maps.size(), bundles.light_maps.size());
}

/// Gives up if it may and is told to; else returns its number as the error.
class Step : public Transport {
  public:
    Step(double number, bool gives_up, Reach& reach) : number_(number), gives_up_(gives_up), reach_(reach) {}
    Solution solve(const Environment&, Progress&) override {
        Solution solution;
        reach_.gave_up = gives_up_ && reach_.may_give_up;
        solution.estimated_error = number_;
        solution.report.stages.push_back({"step", 0, 0});
        solution.transport_bytes = optics_;
        return solution;
    }
    void set_optics(const std::vector<Optics>& optics) override { optics_ = optics.size(); }
    std::size_t bytes() const override { return 0; }

  private:
    double number_;
    bool gives_up_;
    Reach& reach_;
    std::size_t optics_ = 0;
};

TEST(BundlesSteps, TheNextIsTakenWhereOneGivesUpAndKept) {
    int made = 0;
    auto step = [&](double number, bool gives_up) {
        return [&made, number, gives_up](Reach& reach, Progress&) {
            ++made;
            return std::make_unique<Step>(number, gives_up, reach);
        };
    };
    const auto steps = make_steps({step(1, true), step(2, true), step(3, true)}, silent_progress());
    EXPECT_EQ(made, 1) << "later ones are not made before they are needed";
    steps->set_optics(std::vector<Optics>(5));
    const Solution solution = steps->solve({}, silent_progress());
    EXPECT_EQ(solution.estimated_error, 3) << "the last can't give up";
    EXPECT_EQ(solution.report.stages.size(), 3u) << "their work is reported";
    EXPECT_EQ(solution.transport_bytes, 5u) << "they have the colours that were set";
    EXPECT_EQ(steps->solve({}, silent_progress()).estimated_error, 3);
    EXPECT_EQ(made, 3);
    EXPECT_EQ(
        make_steps({step(1, false), step(2, false)}, silent_progress())->solve({}, silent_progress()).estimated_error,
        1);
}

TEST(BundlesSteps, WhatIsReportedOfAStepThatGaveUpIsKept) {
    class Reporting : public Step {
      public:
        using Step::Step;
        Solution solve(const Environment& environment, Progress& progress) override {
            Solution solution = Step::solve(environment, progress);
            solution.report.counts.push_back({"paths", 7});
            solution.report.counts.push_back({"paths", 5});
            solution.report.skips.push_back({"a light", "weak", "a raster"});
            solution.report.warnings.push_back("a warning");
            return solution;
        }
    };
    const auto steps = make_steps(
        {[](Reach& reach, Progress&) -> std::unique_ptr<Transport> {
             return std::make_unique<Reporting>(1, true, reach);
         },
         [](Reach& reach, Progress&) -> std::unique_ptr<Transport> { return std::make_unique<Step>(2, false, reach); }},
        silent_progress());
    const Solution solution = steps->solve({}, silent_progress());
    EXPECT_EQ(solution.estimated_error, 2);
    ASSERT_EQ(solution.report.counts.size(), 1u);
    EXPECT_EQ(solution.report.counts[0].value, 12u) << "of all that was done";
    EXPECT_EQ(solution.report.skips.size(), 1u);
    EXPECT_TRUE(says(solution, "a warning"));
}

TEST(BundlesSteps, AStepWhoseMakingWasStoppedIsMadeByTheNextSolve) {
    bool stop = true;
    const auto steps = make_steps({[](Reach& reach, Progress&) { return std::make_unique<Step>(1, true, reach); },
                                   [&](Reach& reach, Progress&) {
                                       if (stop)
                                           throw Stopped();
                                       return std::make_unique<Step>(2, false, reach);
                                   }},
                                  silent_progress());
    EXPECT_THROW(steps->solve({}, silent_progress()), Stopped);
    EXPECT_EQ(steps->bytes(), 0u);
    steps->set_optics(std::vector<Optics>(3));
    EXPECT_THROW(steps->solve({}, silent_progress()), Stopped);
    stop = false;
    const Solution solution = steps->solve({}, silent_progress());
    EXPECT_EQ(solution.estimated_error, 2);
    EXPECT_EQ(solution.transport_bytes, 3u) << "the colours that were set meanwhile";
}

/// Stops when the nth stage of the work begins.
class StopAt : public Progress {
  public:
    explicit StopAt(int nth) : left_(nth) {}
    void begin(std::string_view, std::size_t) override { --left_; }
    bool stop_requested() const override { return left_ <= 0; }
    bool stopped() const { return left_ <= 0; }

  private:
    std::atomic<int> left_;
};

/// Solves, stopped at one stage after another, each time followed by a whole solve(). Returns the number of stops.
int expect_stops_change_nothing(const Environment& environment,
                                const std::function<std::unique_ptr<Transport>()>& make) {
    const Solution whole = make()->solve(environment, silent_progress());
    for (int stops = 0;; ++stops) {
        SCOPED_TRACE(stops);
        const auto transport = make();
        StopAt progress(stops + 1);
        try {
            transport->solve(environment, progress);
            if (!progress.stopped())
                return stops;
        } catch (const Stopped&) {
        }
        const Solution again = transport->solve(environment, silent_progress());
        EXPECT_EQ(again.radiance.front, whole.radiance.front);
        EXPECT_EQ(again.radiance.back, whole.radiance.back);
        EXPECT_EQ(again.estimated_error, whole.estimated_error);
        if (testing::Test::HasFailure())
            return stops;
    }
}

TEST(BundlesSteps, ASolveAfterAStoppedOneGivesTheSame) {
    const test::SmallTree small = leaves_on_a_half_lit_card();
    ShadingOptions options;
    options.error = 0.05; // out of reach of bundles: paths are traced
    EXPECT_GE(expect_stops_change_nothing(
                  sun_overhead(), [&] { return make_transport(small.scene, small.tree, options, silent_progress()); }),
              2);
}

TEST(BundlesSteps, ASolveThatWasStoppedWhileMoreLinesWereDrawnGoesOnWithTheOldOnes) {
    const test::SmallTree small = test::ball_on_a_skeleton(1500, 1, test::bright_leaf());
    ShadingOptions options;
    options.error = 0.05;
    const BundleEffort few_lines = effort_of_directions(8, mean_leaf_albedo(small.scene), 1);
    auto make = [&] { return make_refined_bundles_transport(small.scene, few_lines, options, silent_progress()); };
    const Solution solution = make()->solve(test::sky_and_sun(), silent_progress());
    auto stages = [&](const char* name) {
        return std::count_if(solution.report.stages.begin(), solution.report.stages.end(),
                             [&](const WorkReport::Stage& stage) { return stage.name == name; });
    };
    EXPECT_GE(stages("line bundles"), 2);
    EXPECT_GE(checks(solution), stages("line bundles") + 1) << "of all lines, and twice of the last";
    EXPECT_GE(expect_stops_change_nothing(test::sky_and_sun(), make), 2);
}

} // namespace
} // namespace kokage

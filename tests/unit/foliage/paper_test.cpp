#include "common/services/error.h"
#include "common/services/parallel.h"
#include "foliage/map_reading.h"
#include "foliage/paper.h"
#include "foliage/patch_geometry.h"
#include "tests/unit/foliage/shade_small_trees.h"
#include "tests/unit/foliage/solution_checks.h"

#include <algorithm>
#include <gtest/gtest.h>

namespace kokage {
namespace {

ShadingOptions paper_options() {
    ShadingOptions options;
    options.method = Method::paper;
    return options;
}

using test::shade;
Solution shade_by_paper(const test::SmallTree& small, const Environment& environment) {
    return shade(small, environment, paper_options());
}

std::uint64_t reported(const Solution& solution, const std::string& name) {
    for (const WorkReport::Count& count : solution.report.counts)
        if (count.name == name)
            return count.value;
    ADD_FAILURE() << "no count of " << name;
    return 0;
}

TEST(Paper, ALoneLeafFarFromEverythingTakesRhoPlusTauOfTheSky) {
    test::SmallTree lone;
    lone.scene.optics = {test::realistic_leaf()};
    test::add_rectangle(lone.scene, {0, 100, 0}, {1e-3f, 0, 0}, {0, 0, 1e-3f});
    test::add_branch(lone.tree.skeleton, -1, {0, 0, 0}, {0, 1, 0});
    test::add_branch(lone.tree.skeleton, 0, {0, 1, 0}, {0, 2, 0});
    lone.tree.leaves = {{{0, 100, 0}, 1}};
    const Solution solution = shade_by_paper(lone, constant_environment({1, 2, 4}));
    const glm::vec3 expected = glm::vec3(1, 2, 4) * glm::vec3(0.18f, 0.5f, 0.1f);
    EXPECT_LT(glm::distance(solution.radiance.front[0], expected), 1e-4f);
    EXPECT_EQ(solution.radiance.back[0], solution.radiance.front[0]) << "no cosine, both sides alike";
}

TEST(Paper, BarkTakesItsAlbedo) {
    test::SmallTree small;
    small.scene.optics = {{glm::vec3(0.3f), glm::vec3(0)}};
    test::add_rectangle(small.scene, {0, 100, 0}, {1e-3f, 0, 0}, {0, 0, 1e-3f});
    small.scene.patches[0].kind = PatchKind::bark;
    test::add_branch(small.tree.skeleton, -1, {0, 0, 0}, {0, 1, 0});
    test::add_branch(small.tree.skeleton, 0, {0, 1, 0}, {0, 2, 0});
    const Solution solution = shade_by_paper(small, constant_environment(glm::vec3(1)));
    EXPECT_NEAR(solution.radiance.front[0].r, 0.3f, 1e-5f);
}

TEST(Paper, UsesFifteenMapsOfFortyNineCoefficients) {
    const Solution solution =
        shade_by_paper(test::ball_on_a_skeleton(400, 2, test::realistic_leaf()), test::sky_and_sun());
    ASSERT_EQ(solution.light_maps.size(), 15u);
    for (const LightMap& map : solution.light_maps)
        EXPECT_EQ(map.coefficients.size(), 49u);
}

// The whole method once more, plainly: capture, shade by eqs 2-4, capture again, written with none of its batching.
TEST(Paper, AgreesWithItsObviousTwin) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::bright_leaf());
    const Environment environment = test::sky_and_sun();
    ShadingOptions options = paper_options();
    options.maps = 6;
    options.max_bounces = 3;
    const Solution solution = shade(small, environment, options);

    const RayQueries queries(small.scene);
    const CapturedMaps maps(queries, {}, place_light_maps(small.tree, 6).places, 7, 968, silent_progress());
    LightVisibility visibility(queries, maps.points(), 16, options.seed);
    const std::vector<glm::vec3> sky = cell_means(maps.directions(), environment.remainder);
    const PatchGeometry geometry = patch_geometry(small.scene);
    std::vector<glm::vec3> radiance(small.scene.patches.size(), glm::vec3(0.f));
    for (int bounce = 0; bounce <= 3; ++bounce) {
        MapCoefficients coefficients(6, 7);
        maps.add_lights(environment, visibility, queries.ray_offset(), coefficients, silent_progress());
        maps.add_sky(sky, coefficients);
        maps.add_surfaces({radiance, radiance}, {}, coefficients);
        for (std::size_t p = 0; p < radiance.size(); ++p) {
            glm::vec3 sum{0.f};
            for (std::size_t i = 0; i < 6; ++i)
                sum += read_map(coefficients, i, reading_direction(maps.places()[i], geometry.centres[p]));
            radiance[p] = glm::vec3(0.9f) * glm::max(sum / 6.f, glm::vec3(0.f));
        }
    }
    EXPECT_EQ(solution.residuals.size(), 4u);
    for (std::size_t p = 0; p < radiance.size(); ++p)
        EXPECT_LT(glm::distance(solution.radiance.front[p], radiance[p]), 2e-4f * (1 + glm::length(radiance[p]))) << p;
}

TEST(Paper, MoreBouncesMeanMoreLightInsideABrightCrown) {
    const test::SmallTree small = test::ball_on_a_skeleton(1500, 3, test::bright_leaf());
    ShadingOptions once = paper_options(), all = paper_options();
    once.max_bounces = 1;
    const auto mean = [](const Solution& solution) {
        double sum = 0;
        for (const glm::vec3& value : solution.radiance.front)
            sum += value.g;
        return sum / double(solution.radiance.front.size());
    };
    EXPECT_GT(mean(shade(small, test::sky_and_sun(), all)), 1.05 * mean(shade(small, test::sky_and_sun(), once)));
}

TEST(Paper, RelightingTracesOnlyWhatMoved) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    Environment environment = test::sky_and_sun();
    const auto transport = make_paper_transport(small.scene, small.tree, paper_options(), silent_progress());
    const std::uint64_t rays = reported(transport->solve(environment, silent_progress()), "rays");
    environment.remainder = constant_environment(glm::vec3(3)).remainder;
    const Solution relit = transport->solve(environment, silent_progress());
    EXPECT_EQ(reported(relit, "rays"), rays);
    EXPECT_EQ(relit.radiance.front, shade_by_paper(small, environment).radiance.front)
        << "the same bits as a fresh solve";
    environment.distant_lights[0].direction = {0, 1, 0};
    const Solution moved = transport->solve(environment, silent_progress());
    EXPECT_EQ(reported(moved, "rays"), rays + 15 * 16);
    EXPECT_EQ(moved.radiance.front, shade_by_paper(small, environment).radiance.front);
}

TEST(Paper, ChangedOpticsNeedNoNewTransport) {
    test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    const auto transport = make_paper_transport(small.scene, small.tree, paper_options(), silent_progress());
    transport->set_optics({test::bright_leaf()});
    const Solution changed = transport->solve(test::sky_and_sun(), silent_progress());
    small.scene.optics = {test::bright_leaf()};
    EXPECT_EQ(changed.radiance.front, shade_by_paper(small, test::sky_and_sun()).radiance.front);
}

TEST(Paper, IndirectLeavesOutTheUnscatteredSun) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    Environment sun_only = test::sky_and_sun();
    sun_only.remainder = constant_environment(glm::vec3(0)).remainder;
    test::SmallTree black = small;
    black.scene.optics = {
        Optics{glm::vec3(1e-9f), glm::vec3(0)}}; // sends on a little of what arrives first, next to nothing of the rest
    const Solution solution = shade_by_paper(black, sun_only);
    for (std::size_t p = 0; p < solution.indirect.front.size(); ++p)
        EXPECT_LE(glm::length(solution.indirect.front[p]), 1e-6f * glm::length(solution.radiance.front[p]) + 1e-15f);
    const Solution no_sun = shade_by_paper(small, constant_environment(glm::vec3(1)));
    for (std::size_t p = 0; p < no_sun.indirect.front.size(); ++p)
        EXPECT_EQ(no_sun.indirect.front[p], no_sun.radiance.front[p]);
}

TEST(Paper, DoesNotDependOnThreads) {
    const test::SmallTree small = test::ball_on_a_skeleton(800, 2, test::realistic_leaf());
    set_thread_count(1);
    const Solution one = shade_by_paper(small, test::sky_and_sun());
    set_thread_count(2);
    const Solution two = shade_by_paper(small, test::sky_and_sun());
    set_thread_count(0);
    EXPECT_EQ(one.radiance.front, two.radiance.front);
    EXPECT_EQ(one.residuals, two.residuals);
    EXPECT_EQ(one.energy_escaped, two.energy_escaped);
}

TEST(Paper, NothingAndOneLeafAndNoBranchingAreFine) {
    test::SmallTree nothing;
    const Solution empty = shade_by_paper(nothing, test::sky_and_sun());
    EXPECT_TRUE(empty.radiance.front.empty());
    EXPECT_EQ(empty.residuals, std::vector<double>{0});

    test::SmallTree one;
    one.scene.optics = {test::realistic_leaf()};
    test::add_rectangle(one.scene, {0, 1, 0}, {0.1f, 0, 0}, {0, 0, 0.1f});
    one.tree.leaves = {{{0.05f, 1, 0.05f}, -1}}; // unknown branch: the only map stands exactly at the leaf
    const Solution lone = shade_by_paper(one, test::sky_and_sun());
    test::expect_finite(lone);
    EXPECT_GT(lone.radiance.front[0].g, 0);
    EXPECT_TRUE(std::any_of(lone.report.warnings.begin(), lone.report.warnings.end(), [](const std::string& text) {
        return text.find("no branching points") != std::string::npos;
    }));
}

TEST(Paper, GroundLightsTheCrownFromBelow) {
    test::SmallTree small = test::ball_on_a_skeleton(300, 1, test::realistic_leaf());
    const Environment upper = test::upper_sky_and_sun();
    const Solution without = shade_by_paper(small, upper);
    small.scene.ground = Ground{0, glm::vec3(0.5f)};
    const Solution with = shade_by_paper(small, upper);
    double sum_without = 0, sum_with = 0;
    for (std::size_t p = 0; p < small.scene.patches.size(); ++p) {
        sum_without += without.radiance.front[p].g;
        sum_with += with.radiance.front[p].g;
    }
    EXPECT_GT(sum_with, 1.1 * sum_without);
    test::expect_finite(with);
}

TEST(Paper, RefusesSettingsOutOfRange) {
    const test::SmallTree small = test::ball_on_a_skeleton(10, 1, test::realistic_leaf());
    ShadingOptions options = paper_options();
    options.maps = -1;
    EXPECT_THROW(make_paper_transport(small.scene, small.tree, options, silent_progress()), InputError);
    options.maps = 1;
    options.bands = 41;
    EXPECT_THROW(make_paper_transport(small.scene, small.tree, options, silent_progress()), InputError);
}

} // namespace
} // namespace kokage

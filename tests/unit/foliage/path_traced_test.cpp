// The method `path-traced`: analytic scenes, honesty of its error estimate, energy, and its figures beside radiance.
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "foliage/accuracy.h"
#include "foliage/path_traced.h"
#include "foliage/side_paths.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

Solution shade_by_paths(const PatchScene& scene, const Environment& environment, int effort, std::uint64_t seed = 1) {
    ShadingOptions options;
    options.method = Method::path_traced;
    options.effort = effort;
    options.seed = seed;
    return make_path_traced_transport(scene, Tree{}, options, silent_progress())->solve(environment, silent_progress());
}

std::uint64_t count(const Solution& solution, const std::string& name) {
    for (const WorkReport::Count& entry : solution.report.counts)
        if (entry.name == name)
            return entry.value;
    ADD_FAILURE() << "no count " << name;
    return 0;
}

void expect_near(const glm::vec3& value, const glm::vec3& expected, float tolerance) {
    for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(value[c], expected[c], tolerance) << "channel " << c;
}

TEST(PathTraced, LoneLeafUnderSunAndSkyIsAnalytic) {
    PatchScene scene;
    scene.optics = {{{0.1f, 0.2f, 0.3f}, {0.4f, 0.3f, 0.2f}}};
    test::add_rectangle(scene, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0}); // front is +Y
    Environment environment = constant_environment({1, 2, 3});
    DistantLight sun;
    sun.direction = {0.6f, 0.8f, 0};
    sun.irradiance = {10, 9, 8};
    environment.distant_lights.push_back(sun);
    const Solution solution = shade_by_paths(scene, environment, 32);
    const glm::vec3 sky = kPi * glm::vec3(1, 2, 3), direct = 0.8f * sun.irradiance;
    const glm::vec3 rho = scene.optics[0].reflectance, tau = scene.optics[0].transmittance;
    expect_near(solution.radiance.front[0], (rho * (sky + direct) + tau * sky) / kPi, 1e-4f);
    expect_near(solution.radiance.back[0], (rho * sky + tau * (sky + direct)) / kPi, 1e-4f);
    expect_near(solution.indirect.front[0], (rho + tau) * sky / kPi, 1e-4f);
    expect_near(solution.indirect.back[0], (rho + tau) * sky / kPi, 1e-4f);
    EXPECT_EQ(solution.sky_visibility_front[0], 1);
    EXPECT_EQ(solution.sky_visibility_back[0], 1);
    EXPECT_NEAR((solution.energy_absorbed + solution.energy_escaped) / solution.energy_in, 1, 1e-5);
    const double expected_in = 4.0 * double(luminance(2.f * sky + direct));
    EXPECT_NEAR(solution.energy_in, expected_in, 1e-4 * expected_in);
}

TEST(PathTraced, SkyVisibilityAndBentNormal) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {0, 1, 0}, {0, 0.1f, 0}, {0, 0, 0.1f});  // upright, over a ground
    test::add_rectangle(scene, {50, 1, 0}, {0, 0, 0.1f}, {0.1f, 0, 0}); // front is +Y
    scene.ground = Ground{0, glm::vec3(0)};
    const Solution solution = shade_by_paths(scene, constant_environment(glm::vec3(1)), 4096);
    EXPECT_NEAR(solution.sky_visibility_front[0], 0.5, 0.005);
    EXPECT_NEAR(solution.sky_visibility_back[0], 0.5, 0.005);
    EXPECT_NEAR(solution.sky_visibility_front[1], 1, 1e-6);
    EXPECT_EQ(solution.sky_visibility_back[1], 0);
    EXPECT_GT(solution.bent_normal[0].y, 0.99f); // both sides together
    EXPECT_GT(solution.bent_normal[1].y, 0.99f);
}

TEST(PathTraced, EstimatedErrorIsHonest) {
    // On different scenes, materials, lights and efforts, against a reference whose noise is a small part of the error.
    struct Case {
        const char* name;
        PatchScene scene;
        Environment environment;
    };
    std::vector<Case> cases;
    cases.push_back({"realistic", test::random_crown(150, 3.5f, test::realistic_leaf()), test::sky_and_sun()});
    cases.push_back(
        {"bright, constant sky", test::random_crown(150, 3.5f, test::bright_leaf()), constant_environment({1, 2, 3})});
    cases.push_back({"masked", test::random_crown(150, 5, test::realistic_leaf()), test::sky_and_sun()});
    test::mask_rectangles(cases.back().scene, test::checkered_mask(4));
    cases.push_back(
        {"lamps beside", test::random_crown(150, 3.5f, test::bright_leaf()), constant_environment(glm::vec3(0.1f))});
    for (int i = 0; i < 3; ++i)
        cases.back().environment.point_lights.push_back(
            {"", {1.3f, 1.5f + 0.5f * float(i), 0.1f}, glm::vec3(1, 0.8f, 0.5f)});
    for (const Case& c : cases) {
        std::vector<double> areas(c.scene.leaf_count, 1.0);
        const PathTracedReference reference = path_trace_reference(c.scene, c.environment, 4096, 77, silent_progress());
        for (const int effort : {4, 16, 64}) {
            const Solution solution = shade_by_paths(c.scene, c.environment, effort);
            const double mre = accuracy(leaf_side_radiance(c.scene, solution.radiance), reference.sides, areas).mre;
            ASSERT_LT(reference.noise, mre / 5) << c.name;
            ASSERT_TRUE(solution.estimated_error);
            const double ratio = *solution.estimated_error / mre;
            EXPECT_GT(ratio, 1 / 1.4) << c.name << ", effort " << effort << ", mre " << mre;
            EXPECT_LT(ratio, 1.4) << c.name << ", effort " << effort << ", mre " << mre;
        }
    }
}

TEST(PathTraced, AskedErrorIsReached) {
    const PatchScene scene = test::random_crown(150, 3.5f, test::realistic_leaf());
    const Environment environment = test::sky_and_sun();
    const PathTracedReference reference = path_trace_reference(scene, environment, 4096, 77, silent_progress());
    for (const double asked : {0.2, 0.05}) {
        ShadingOptions options;
        options.error = asked;
        const auto transport = make_path_traced_transport(scene, Tree{}, options, silent_progress());
        const Solution solution = transport->solve(environment, silent_progress());
        const double mre = accuracy(leaf_side_radiance(scene, solution.radiance), reference.sides,
                                    std::vector<double>(scene.leaf_count, 1.0))
                               .mre;
        EXPECT_LE(*solution.estimated_error, asked);
        EXPECT_LT(mre, 1.15 * asked);
        EXPECT_LT(count(solution, "paths a leaf side"), asked > 0.1 ? 40u : 400u);
    }
}

TEST(PathTraced, SameBitsForAnyNumberOfThreads) {
    const PatchScene scene = test::random_crown(300, 3.5f, test::bright_leaf());
    const Environment environment = test::sky_and_sun();
    set_thread_count(1);
    const Solution one = shade_by_paths(scene, environment, 6);
    set_thread_count(3);
    const Solution three = shade_by_paths(scene, environment, 6);
    set_thread_count(0);
    EXPECT_EQ(one.radiance.front, three.radiance.front);
    EXPECT_EQ(one.radiance.back, three.radiance.back);
    EXPECT_EQ(one.indirect.front, three.indirect.front);
    EXPECT_EQ(one.bent_normal, three.bent_normal);
    EXPECT_EQ(one.energy_escaped, three.energy_escaped);
    EXPECT_EQ(*one.estimated_error, *three.estimated_error);
    EXPECT_NE(shade_by_paths(scene, environment, 6, 2).radiance.front, one.radiance.front)
        << "another seed, other noise";
}

TEST(PathTraced, EnergyBalancesAtEveryAlbedo) {
    for (const float albedo : {0.5f, 0.9f, 0.99f, 1.f}) {
        PatchScene scene = test::random_crown(400, 3.5f, test::grey_leaf(albedo));
        const Solution solution = shade_by_paths(scene, test::sky_and_sun(), 64);
        EXPECT_NEAR((solution.energy_absorbed + solution.energy_escaped) / solution.energy_in, 1, 0.01) << albedo;
        EXPECT_LT(solution.energy_absorbed, solution.energy_in * 1.01);
        if (albedo == 1) {
            EXPECT_NEAR(solution.energy_absorbed / solution.energy_in, 0, 1e-5);
        }
    }
}

TEST(PathTraced, FurnaceAtAlbedoOne) {
    const PatchScene scene = test::random_crown(300, 4, test::grey_leaf(1));
    const Solution solution = shade_by_paths(scene, constant_environment(glm::vec3(1)), 512);
    double mean = 0;
    for (std::size_t p = 0; p < scene.patches.size(); ++p) {
        mean += 0.5 * double(solution.radiance.front[p].g + solution.radiance.back[p].g) / double(scene.patches.size());
        EXPECT_NEAR(solution.radiance.front[p].g, 1, 0.05);
    }
    EXPECT_NEAR(mean, 1, 0.001);
}

TEST(PathTraced, OpticsChangeWithoutTouchingTheScene) {
    PatchScene scene = test::random_crown(200, 3.5f, test::realistic_leaf());
    const Environment environment = test::sky_and_sun();
    ShadingOptions options;
    options.effort = 8;
    const auto transport = make_path_traced_transport(scene, Tree{}, options, silent_progress());
    const Solution before = transport->solve(environment, silent_progress());
    transport->set_optics({test::bright_leaf()});
    const Solution bright = transport->solve(environment, silent_progress());
    transport->set_optics({test::realistic_leaf()});
    EXPECT_EQ(transport->solve(environment, silent_progress()).radiance.front, before.radiance.front);
    scene.optics = {test::bright_leaf()};
    EXPECT_EQ(shade_by_paths(scene, environment, 8).radiance.front, bright.radiance.front);
    EXPECT_THROW(transport->set_optics({}), InputError);
    EXPECT_GT(transport->bytes(), 1000u);
}

TEST(PathTraced, PathsAreSharedAmongPartsOfALeaf) {
    // One leaf of four parts gets about as many paths as one of a single part, and averages back to the same radiance.
    PatchScene parts;
    parts.optics = {test::bright_leaf()};
    for (int i = 0; i < 4; ++i)
        test::add_rectangle(parts, {0.5f * float(i), 1, 0}, {0, 0, 1}, {0.5f, 0, 0});
    for (Patch& patch : parts.patches)
        patch.leaf = 0;
    parts.leaf_count = 1;
    parts.ground = Ground{};
    const Environment environment = test::sky_and_sun();
    const Solution solution = shade_by_paths(parts, environment, 4000);
    EXPECT_EQ(count(solution, "paths"), 8000u);
    PatchScene whole;
    whole.optics = parts.optics;
    test::add_rectangle(whole, {0, 1, 0}, {0, 0, 1}, {2, 0, 0});
    whole.ground = parts.ground;
    const Solution expected = shade_by_paths(whole, environment, 4000);
    const std::vector<glm::vec3> sides = leaf_side_radiance(parts, solution.radiance);
    expect_near(sides[0] / expected.radiance.front[0], glm::vec3(1), 0.01f);
    expect_near(sides[1] / expected.radiance.back[0], glm::vec3(1), 0.01f);
    EXPECT_EQ(count(shade_by_paths(parts, environment, 1), "paths"), 16u)
        << "at least one path in either half of every part";
}

TEST(PathTraced, BarkIsShadedButNotInReferences) {
    PatchScene scene = test::random_crown(50, 2, test::realistic_leaf());
    test::add_rectangle(scene, {-0.1f, 0, 0}, {0.2f, 0, 0}, {0, 2, 0});
    scene.patches.back().kind = PatchKind::bark;
    --scene.leaf_count;
    const Environment environment = test::sky_and_sun();
    EXPECT_GT(luminance(shade_by_paths(scene, environment, 16).radiance.front.back()), 0.01f);
    const PathTracedReference reference = path_trace_reference(scene, environment, 16, 1, silent_progress());
    EXPECT_EQ(reference.sides.size(), 100u);
    EXPECT_EQ(reference.paths_per_side, 16u);
}

TEST(PathTraced, ReferencesMerge) {
    const PatchScene scene = test::random_crown(200, 3, test::realistic_leaf());
    const Environment environment = test::sky_and_sun();
    const auto a = path_trace_reference(scene, environment, 512, 1, silent_progress());
    const auto b = path_trace_reference(scene, environment, 512, 2, silent_progress());
    const auto merged = merge_references(a, b);
    EXPECT_EQ(merged.paths_per_side, 1024u);
    EXPECT_NEAR(merged.noise / a.noise, std::sqrt(0.5), 0.08);
    expect_near(merged.sides[7], 0.5f * (a.sides[7] + b.sides[7]), 1e-6f);
    // The halves of each are independent of each other: their difference predicts how far the two references are apart.
    double apart = half_sample_error(a.sides, b.sides);
    EXPECT_NEAR(apart / merged.noise, 1, 0.15);
    EXPECT_THROW(merge_references(a, PathTracedReference{}), InputError);
}

TEST(PathTraced, ContinuedPathsEqualPathsTracedAtOnce) {
    const PatchScene scene = test::random_crown(60, 3, test::realistic_leaf());
    const Environment environment = test::sky_and_sun();
    const RayQueries queries(scene);
    const PatchPoints points(scene);
    const PathTracer tracer(queries, environment);
    SidePaths once(scene, points, 5, true), twice(scene, points, 5, true);
    once.extend_to(48, tracer, silent_progress());
    twice.extend_to(7, tracer, silent_progress());
    EXPECT_EQ(twice.paths_per_side(), 8u);
    twice.extend_to(48, tracer, silent_progress());
    twice.extend_to(10, tracer, silent_progress()); // already there
    EXPECT_EQ(twice.paths_per_side(), 48u);
    EXPECT_EQ(once.radiance(scene.optics).front, twice.radiance(scene.optics).front);
    EXPECT_EQ(once.paths_traced(), twice.paths_traced());
}

TEST(PathTraced, StopsWhenAsked) {
    struct Impatient final : Progress {
        bool stop_requested() const override { return true; }
    } impatient;
    const PatchScene scene = test::random_crown(60, 3, test::realistic_leaf());
    ShadingOptions options;
    options.effort = 4;
    const auto transport = make_path_traced_transport(scene, Tree{}, options, silent_progress());
    EXPECT_THROW(transport->solve(test::sky_and_sun(), impatient), Stopped);
}

TEST(PatchPoints, UniformOverSolidArea) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_leaf(scene, {{0, 0, 0}, {3, 0, 0}, {0, 2, 0}, {5, 0, 0}, {6, 0, 0}, {5, 2, 0}}); // areas 3 and 1
    const PatchPoints points(scene);
    int large = 0, near_corner = 0;
    for (std::uint32_t i = 0; i < 40000; ++i) {
        PathNumbers numbers(3, i);
        PatchPoint point;
        ASSERT_TRUE(points.sample(0, numbers, point));
        EXPECT_EQ(point.normal, glm::vec3(0, 0, 1));
        large += point.position.x < 4;
        near_corner += point.position.x / 3 + point.position.y / 2 < 0.5f; // a quarter of the large triangle
    }
    EXPECT_NEAR(large, 30000, 60);
    EXPECT_NEAR(near_corner, 7500, 60);
}

TEST(PatchPoints, HolesAndEmptyPatchesAreLeftOut) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    test::mask_rectangles(scene, test::half_mask());
    PatchPoint point;
    {
        const PatchPoints points(scene);
        for (std::uint32_t i = 0; i < 1000; ++i) {
            PathNumbers numbers(3, i);
            ASSERT_TRUE(points.sample(0, numbers, point));
            EXPECT_LT(point.position.x, 0.5f);
        }
    }
    scene.masks[0].cutoff = 2; // nothing is solid
    PathNumbers numbers(3, 0);
    EXPECT_FALSE(PatchPoints(scene).sample(0, numbers, point));
    const Solution solution = shade_by_paths(scene, test::sky_and_sun(), 4);
    EXPECT_EQ(solution.radiance.front[0], glm::vec3(0));
}

} // namespace
} // namespace kokage

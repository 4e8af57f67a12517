// Leaves that are too small for lines: who gets rays, what the rays see against a slow twin, and the truth.
#include "foliage/bundles/ray_link_tracing.h"

#include "common/services/parallel.h"
#include "foliage/accuracy.h"
#include "foliage/bundles/outside_light.h"
#include "foliage/path_traced.h"
#include "tests/unit/foliage/shade_small_trees.h"
#include "tests/unit/foliage/small_trees.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

using namespace bundles;

/// Every `step`-th leaf becomes `factor` times as large, about its middle. Leaves don't share corners here.
void resize_leaves(PatchScene& scene, std::size_t step, float factor) {
    for (std::size_t p = 0; p < scene.patches.size(); p += step) {
        const Patch& patch = scene.patches[p];
        glm::vec3 middle(0.f);
        for (std::uint32_t k = 0; k < 3 * patch.triangle_count; ++k)
            middle +=
                scene.positions[scene.triangles[patch.first_triangle + k / 3][k % 3]] / float(3 * patch.triangle_count);
        for (std::uint32_t k = 0; k < 3 * patch.triangle_count; ++k) {
            glm::vec3& corner = scene.positions[scene.triangles[patch.first_triangle + k / 3][k % 3]];
            corner = middle + factor * (corner - middle);
        }
    }
}

constexpr std::size_t kStep = 5;

test::SmallTree mixed_ball(std::uint32_t leaves, const Optics& optics) {
    test::SmallTree small = test::ball_on_a_skeleton(leaves, 3, optics);
    resize_leaves(small.scene, kStep, 1 / 6.f);
    return small;
}

Solution shade(const test::SmallTree& small, const Environment& environment, int directions) {
    ShadingOptions options;
    options.effort = directions;
    return test::shade(small, environment, options);
}

std::uint64_t count_of(const Solution& solution, const std::string& name) {
    for (const WorkReport::Count& count : solution.report.counts)
        if (count.name == name)
            return count.value;
    return 0;
}

BundleSettings settings_of(int directions) {
    BundleSettings settings;
    settings.sky_directions = settings.link_directions = directions;
    return settings;
}

TEST(BundlesRayLinks, OnlyLeavesFarBelowTheMeanGetRays) {
    PatchScene scene = test::random_crown(200, 3, test::realistic_leaf());
    for (int directions : {4, 20, 200}) // chance may leave any of them without a line
        EXPECT_TRUE(leaves_too_small_for_lines(scene, make_facets(scene), settings_of(directions)).empty());
    resize_leaves(scene, 2, 0.6f); // two sizes, as in a natural crown
    for (int directions : {4, 20, 200})
        EXPECT_TRUE(leaves_too_small_for_lines(scene, make_facets(scene), settings_of(directions)).empty());
    resize_leaves(scene, 10, 0.2f); // 0.0144 of a full leaf's area
    const std::vector<std::uint32_t> small = leaves_too_small_for_lines(scene, make_facets(scene), settings_of(20));
    ASSERT_EQ(small.size(), 20u);
    for (std::size_t i = 0; i < small.size(); ++i)
        EXPECT_EQ(small[i], 10 * i);
}

TEST(BundlesRayLinks, AnAlmostEmptyCardGetsRaysButNoBarkAndNothingWithoutArea) {
    PatchScene scene = test::random_crown(50, 3, test::realistic_leaf());
    test::add_rectangle(scene, {0, 4, 0}, {1, 0, 0}, {0, 0, 0}); // no area
    test::add_rectangle(scene, {0, 5, 0}, {0.001f, 0, 0}, {0, 0, 0.001f});
    scene.patches.back().kind = PatchKind::bark;
    --scene.leaf_count;
    test::mask_rectangles(scene, test::checkered_mask(4));
    EXPECT_TRUE(leaves_too_small_for_lines(scene, make_facets(scene), settings_of(20)).empty());
    // One card shows a corner of the mask where a single texel of a fine one is solid.
    Image alpha(16, 16, 1);
    *alpha.at(3, 3) = 1;
    AlphaMask sparse;
    sparse.alpha = std::make_shared<const Image>(alpha);
    scene.masks.push_back(sparse);
    for (std::uint32_t t = 0; t < scene.patches[7].triangle_count; ++t)
        scene.triangle_mask[scene.patches[7].first_triangle + t] = 1;
    EXPECT_EQ(leaves_too_small_for_lines(scene, make_facets(scene), settings_of(20)), std::vector<std::uint32_t>{7});
}

/// Nearest solid triangle by testing all of them; -1 if none. Moller and Trumbore 1997.
int nearest_triangle(const PatchScene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
    int nearest = -1;
    double distance = 1e30;
    for (std::size_t t = 0; t < scene.triangles.size(); ++t) {
        const glm::uvec3 corners = scene.triangles[t];
        const glm::dvec3 a(scene.positions[corners.x]), e1 = glm::dvec3(scene.positions[corners.y]) - a,
                                                        e2 = glm::dvec3(scene.positions[corners.z]) - a;
        const glm::dvec3 p = glm::cross(direction, e2);
        const double determinant = glm::dot(e1, p);
        if (std::abs(determinant) < 1e-30)
            continue;
        const glm::dvec3 from = origin - a, q = glm::cross(from, e1);
        const double u = glm::dot(from, p) / determinant, v = glm::dot(direction, q) / determinant,
                     at = glm::dot(e2, q) / determinant;
        if (u < 0 || v < 0 || u + v > 1 || at < 1e-5 || at > distance)
            continue;
        const glm::vec2 uv = scene.uvs[corners.x] + float(u) * (scene.uvs[corners.y] - scene.uvs[corners.x]) +
                             float(v) * (scene.uvs[corners.z] - scene.uvs[corners.x]);
        if (scene.masked(t) && !scene.masks[std::size_t(scene.triangle_mask[t])].solid(uv))
            continue;
        nearest = int(t);
        distance = at;
    }
    return nearest;
}

/// Shares of a side's rays by what they meet: all sides of the scene, then sky, then ground.
std::vector<double> seen_by_brute_force(const PatchScene& scene, Side side, int rays) {
    std::vector<double> shares(2 * scene.patches.size() + 2, 0.0);
    const Patch& patch = scene.patches[side / 2];
    Random random(99, side);
    for (int i = 0; i < rays;) {
        // Both triangles of these rectangles are of one size.
        const std::uint32_t t = patch.first_triangle + random.below(patch.triangle_count);
        const glm::uvec3 corners = scene.triangles[t];
        float u = random.uniform(), v = random.uniform();
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const auto at = [&](const auto& of) {
            return of[corners.x] + u * (of[corners.y] - of[corners.x]) + v * (of[corners.z] - of[corners.x]);
        };
        if (scene.masked(t) && !scene.masks[std::size_t(scene.triangle_mask[t])].solid(at(scene.uvs)))
            continue;
        glm::vec3 normal = glm::normalize(glm::cross(scene.positions[corners.y] - scene.positions[corners.x],
                                                     scene.positions[corners.z] - scene.positions[corners.x]));
        if (side % 2)
            normal = -normal;
        // A point of the sphere around the normal's tip: its direction is cosine-distributed.
        const glm::vec3 sum = normal + test::random_direction(random);
        if (!(glm::length(sum) > 1e-3f))
            continue;
        const glm::vec3 direction = glm::normalize(sum);
        const int met = nearest_triangle(scene, glm::dvec3(at(scene.positions)), glm::dvec3(direction));
        ++i;
        if (met < 0) {
            shares[shares.size() - (direction.y < 0 && scene.ground ? 1 : 2)] += 1.0 / rays;
            continue;
        }
        const glm::uvec3 hit = scene.triangles[std::size_t(met)];
        const glm::vec3 facing = glm::cross(scene.positions[hit.y] - scene.positions[hit.x],
                                            scene.positions[hit.z] - scene.positions[hit.x]);
        shares[2 * scene.triangle_patch[std::size_t(met)] + (glm::dot(facing, direction) > 0)] += 1.0 / rays;
    }
    return shares;
}

struct Traced {
    PatchScene scene;
    Facets facets;
    BundleTransport transport;
    explicit Traced(PatchScene tree, std::uint32_t rays, int directions = 16)
        : scene(std::move(tree)), facets(make_facets(scene)) {
        const BundleSettings settings = settings_of(directions);
        transport = trace_bundles(scene, facets, settings, silent_progress());
        add_ray_links(RayQueries(scene), PatchPoints(scene), facets,
                      leaves_too_small_for_lines(scene, facets, settings), rays, 1, {}, transport, silent_progress());
    }
};

TEST(BundlesRayLinks, RaysSeeWhatTheSlowTwinSees) {
    PatchScene scene = mixed_ball(40, test::realistic_leaf()).scene;
    test::mask_rectangles(scene, test::checkered_mask(4));
    for (bool ground : {false, true}) {
        if (ground)
            scene.ground = Ground{0.8f};
        constexpr int kRays = 16384;
        const Traced traced(scene, kRays);
        const RayLinks& rays = traced.transport.rays;
        ASSERT_EQ(rays.patches.size(), 8u);
        const SkyLight sky = gather_sky(traced.scene, traced.facets, traced.transport,
                                        constant_environment(glm::vec3(1)).remainder, glm::vec3(0));
        for (std::uint32_t patch : {rays.patches[1], rays.patches[4]})
            for (Side side = 2 * patch; side < 2 * patch + 2; ++side) {
                constexpr int kSlowRays = 8192;
                const std::vector<double> expected = seen_by_brute_force(scene, side, kSlowRays);
                const double open = double(sky.all.open[side]), down = double(sky.all.down[side]);
                std::vector<double> found(expected.size(), 0.0);
                const std::span<const Side> row = traced.transport.links.row(side);
                for (const Side neighbour : row)
                    found[neighbour] += (1 - open) / double(row.size());
                found[found.size() - 2] = ground ? open - down : open;
                found.back() = ground ? down : 0;
                for (std::size_t k = 0; k < expected.size(); ++k) {
                    const double deviation = std::sqrt(expected[k] * (1 - expected[k]) / kSlowRays);
                    EXPECT_NEAR(found[k], expected[k], 5 * deviation + 5e-4) << "side " << side << " sees " << k;
                }
            }
    }
}

TEST(BundlesRayLinks, OtherRowsStayAndAllAreStochastic) {
    const PatchScene scene = mixed_ball(200, test::realistic_leaf()).scene;
    const Facets facets = make_facets(scene);
    const BundleTransport plain = trace_bundles(scene, facets, settings_of(16), silent_progress());
    const Traced traced(scene, 64);
    const Links &before = plain.links, &after = traced.transport.links;
    const SkyLight sky = gather_sky(scene, facets, traced.transport, test::sky_and_sun().remainder, glm::vec3(0));
    ASSERT_EQ(after.side_count(), before.side_count());
    ASSERT_EQ(traced.transport.rays.patches.size(), 40u);
    for (Side side = 0; side < after.side_count(); ++side) {
        ASSERT_FALSE(after.row(side).empty());
        if (side / 2 % kStep != 0) {
            EXPECT_TRUE(std::ranges::equal(before.row(side), after.row(side)));
            EXPECT_EQ(after.half_row(side, 0).size(), before.half_row(side, 0).size());
            continue;
        }
        // Each half: as many rays met something as its closed share says.
        const std::size_t met[2] = {after.half_row(side, 0).size(), after.half_row(side, 1).size()};
        for (int h = 0; h < 2 && sky.all.open[side] < 1; ++h)
            EXPECT_NEAR(double(sky.halves[h].open[side]), 1 - double(met[h]) / 32.0, 1e-5);
    }
}

TEST(BundlesRayLinks, AFurnaceOfTinyAndLargeLeavesIsOneEverywhere) {
    const test::SmallTree small = mixed_ball(500, {{0.5f, 0.9f, 0}, {0.5f, 0.1f, 1}});
    const Solution solution = shade(small, constant_environment(glm::vec3(1)), 20);
    EXPECT_EQ(count_of(solution, "leaves too small for lines"), 100u);
    for (const auto* side : {&solution.radiance.front, &solution.radiance.back})
        for (const glm::vec3& value : *side)
            for (std::size_t c = 0; c < 3; ++c)
                ASSERT_NEAR(value[c], 1, 1e-4);
}

/// A wide card and, half a metre above its middle, a tiny leaf.
test::SmallTree leaf_above_a_card(const Optics& leaf, const Optics& card) {
    test::SmallTree pair;
    pair.scene.optics = {leaf, card};
    test::add_rectangle(pair.scene, {-100, 0, -100}, {0, 0, 200}, {200, 0, 0}, 1); // fronts are +Y
    test::add_rectangle(pair.scene, {0, 0.5f, 0}, {0, 0, 0.001f}, {0.001f, 0, 0});
    return pair;
}

TEST(BundlesRayLinks, ATinyLeafAboveAWideCardSeesIt) {
    const test::SmallTree pair = leaf_above_a_card(test::realistic_leaf(), {glm::vec3(0.5f), glm::vec3(0)});
    Environment environment = constant_environment({1, 2, 3});
    DistantLight sun;
    sun.direction = {0.6f, 0.8f, 0};
    sun.irradiance = {10, 9, 8};
    environment.distant_lights = {sun};
    const Solution solution = shade(pair, environment, 20);
    EXPECT_EQ(count_of(solution, "leaves too small for lines"), 1u);
    EXPECT_EQ(count_of(solution, "rays from small leaves"), 2u * 20);
    EXPECT_GT(count_of(solution, "light rays from small leaves"), 0u);
    const glm::vec3 above = kPi * glm::vec3(1, 2, 3) + 0.8f * sun.irradiance, below = 0.5f * above;
    const glm::vec3 rho = test::realistic_leaf().reflectance, tau = test::realistic_leaf().transmittance;
    const glm::vec3 front = (rho * above + tau * below) / kPi, back = (rho * below + tau * above) / kPi;
    EXPECT_LT(glm::distance(solution.radiance.front[1], front), 0.01f * glm::length(front));
    EXPECT_LT(glm::distance(solution.radiance.back[1], back), 0.01f * glm::length(back));
    EXPECT_NEAR(solution.sky_visibility_front[1], 1, 1e-6);
    EXPECT_NEAR(solution.sky_visibility_back[1], 0, 0.05);
}

TEST(BundlesRayLinks, LightsAddUpAndCastShadowsOnTinyLeaves) {
    const Optics leaf{{0.1f, 0.2f, 0.3f}, glm::vec3(0)};
    Environment environment = constant_environment(glm::vec3(0));
    DistantLight window; // two texels of different colours
    window.texels = {{{0.6f, 0.8f, 0}, {4, 0, 1}, 0}, {{0, 0.8f, 0.6f}, {0, 2, 1}, 0}};
    window.direction = glm::normalize(glm::vec3(1, 2, 1));
    window.half_angle = 0.8f;
    window.irradiance = {4, 2, 2};
    DistantLight lamp;
    lamp.direction = {0, 1, 0};
    lamp.irradiance = {1, 1, 3};
    DistantLight from_below = lamp;
    from_below.direction = {0, -1, 0}; // the card is in the way
    environment.distant_lights = {window, lamp, from_below};
    const test::SmallTree pair = leaf_above_a_card(leaf, {glm::vec3(0), glm::vec3(0)});
    ShadingOptions options;
    options.effort = 400;
    const auto transport = make_transport(pair.scene, pair.tree, options, silent_progress());
    const auto check = [&](const Solution& solution) {
        glm::vec3 expected(0.f);
        for (const DistantLight& light : environment.distant_lights)
            for (const DistantLight::Texel& texel : light.texels)
                expected += 0.8f * texel.irradiance;
        expected = leaf.reflectance / kPi * (expected + environment.distant_lights[1].irradiance);
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_NEAR(solution.radiance.front[1][c], expected[c], 0.06f * expected[c]) << c;
        EXPECT_EQ(solution.radiance.back[1], glm::vec3(0));
    };
    check(transport->solve(environment, silent_progress()));
    environment.distant_lights[1].irradiance = {5, 0, 1};
    check(transport->solve(environment, silent_progress()));
    environment.distant_lights.pop_back();
    check(transport->solve(environment, silent_progress()));
}

TEST(BundlesRayLinks, ALoneTinyLeafNeedsNoRays) {
    test::SmallTree lone;
    lone.scene.optics = {test::grey_leaf(0.5f)};
    test::add_rectangle(lone.scene, {3, 1, 2}, {1e-5f, 0, 0}, {0, 0, 1e-5f});
    const Solution solution = shade(lone, constant_environment(glm::vec3(2)), 20);
    EXPECT_EQ(count_of(solution, "leaves too small for lines"), 0u);
    EXPECT_NEAR(solution.radiance.front[0].r, 1, 1e-3);
}

TEST(BundlesRayLinks, MoreRaysGoOnWhereFewerEnded) {
    PatchScene scene = mixed_ball(200, test::realistic_leaf()).scene;
    scene.ground = Ground{0.8f};
    const Traced fewer(scene, 24), fresh(scene, 80);
    BundleTransport continued = trace_bundles(scene, fresh.facets, settings_of(16), silent_progress());
    std::vector<std::uint32_t> patches = fresh.transport.rays.patches;
    add_ray_links(RayQueries(scene), PatchPoints(scene), fresh.facets, patches, 80, 1, fewer.transport, continued,
                  silent_progress());
    EXPECT_EQ(continued.rays.ends, fresh.transport.rays.ends);
    EXPECT_EQ(continued.rays.end_begin, fresh.transport.rays.end_begin);
    EXPECT_EQ(continued.links.neighbours, fresh.transport.links.neighbours);
    EXPECT_EQ(continued.links.middle, fresh.transport.links.middle);
    EXPECT_NE(continued.rays.ends, fewer.transport.rays.ends);
}

/// MRE over the shrunken leaves and over all.
struct MixedErrors {
    double small = 0, all = 0;
};

MixedErrors mixed_errors(const PatchScene& scene, const Solution& solution, const PathTracedReference& reference) {
    const std::vector<glm::vec3> sides = leaf_side_radiance(scene, solution.radiance);
    const std::vector<double> areas = solid_areas(scene);
    MixedErrors errors;
    errors.all = accuracy(sides, reference.sides, areas).mre;
    std::vector<glm::vec3> found, expected;
    std::vector<double> small_areas;
    for (std::size_t leaf = 0; leaf < areas.size(); leaf += kStep) {
        small_areas.push_back(areas[leaf]);
        for (std::size_t side = 2 * leaf; side < 2 * leaf + 2; ++side) {
            found.push_back(sides[side]);
            expected.push_back(reference.sides[side]);
        }
    }
    errors.small = accuracy(found, expected, small_areas).mre;
    return errors;
}

TEST(BundlesRayLinks, TinyLeavesComeNearTheTruth) {
    for (bool ground : {false, true}) {
        test::SmallTree small = mixed_ball(500, test::realistic_leaf());
        if (ground)
            small.scene.ground = Ground{0.8f, glm::vec3(0.5f)};
        const PathTracedReference reference =
            path_trace_reference(small.scene, test::sky_and_sun(), 1024, 1, silent_progress());
        const Solution solution = shade(small, test::sky_and_sun(), 80);
        const MixedErrors errors = mixed_errors(small.scene, solution, reference);
        EXPECT_LT(errors.small, 0.08) << ground; // by lines alone: 40 %
        EXPECT_LT(errors.all, 0.05) << ground;
        const double own = std::sqrt(std::max(errors.all * errors.all - reference.noise * reference.noise, 1e-8));
        EXPECT_GT(*solution.estimated_error / own, 1 / 1.5);
        EXPECT_LT(*solution.estimated_error / own, 1.5);
    }
}

double largest_difference(const SideRadiance& a, const SideRadiance& b) {
    float difference = 0, largest = 0;
    for (const auto& [x, y] : {std::pair(&a.front, &b.front), std::pair(&a.back, &b.back)})
        for (std::size_t p = 0; p < x->size(); ++p)
            for (std::size_t c = 0; c < 3; ++c) {
                difference = std::max(difference, std::abs((*x)[p][c] - (*y)[p][c]));
                largest = std::max(largest, (*y)[p][c]);
            }
    return double(difference) / double(largest);
}

TEST(BundlesRayLinks, RelightingTracesOnlyTowardsLightsThatMoved) {
    const test::SmallTree small = mixed_ball(300, test::realistic_leaf());
    ShadingOptions options;
    options.effort = 40;
    const auto transport = make_transport(small.scene, small.tree, options, silent_progress());
    Environment environment = test::sky_and_sun();
    const std::string name = "light rays from small leaves";
    EXPECT_GT(count_of(transport->solve(environment, silent_progress()), name), 0u);
    environment.remainder = constant_environment({3, 2, 1}).remainder;
    environment.distant_lights[0].irradiance = {1, 5, 20};
    const Solution recoloured = transport->solve(environment, silent_progress());
    EXPECT_EQ(count_of(recoloured, name), 0u);
    EXPECT_LT(largest_difference(recoloured.radiance, shade(small, environment, 40).radiance), 0.003);
    environment.distant_lights[0].direction = {0, 1, 0};
    const Solution moved = transport->solve(environment, silent_progress());
    EXPECT_GT(count_of(moved, name), 0u);
    EXPECT_LT(largest_difference(moved.radiance, shade(small, environment, 40).radiance), 0.003);
}

TEST(BundlesRayLinks, DoesNotDependOnThreads) {
    test::SmallTree small = mixed_ball(1000, test::realistic_leaf());
    small.scene.ground = Ground{};
    set_thread_count(1);
    const Solution one = shade(small, test::sky_and_sun(), 20);
    set_thread_count(3);
    const Solution more = shade(small, test::sky_and_sun(), 20);
    set_thread_count(0);
    EXPECT_EQ(count_of(one, "leaves too small for lines"), 200u);
    EXPECT_EQ(one.radiance.front, more.radiance.front);
    EXPECT_EQ(one.radiance.back, more.radiance.back);
    EXPECT_EQ(one.estimated_error, more.estimated_error);
}

} // namespace
} // namespace kokage

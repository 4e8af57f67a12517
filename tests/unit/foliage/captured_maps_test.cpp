#include "common/directions/spherical_harmonics.h"
#include "common/environment/light_harmonics.h"
#include "common/services/parallel.h"
#include "foliage/captured_maps.h"
#include "foliage/map_reading.h"
#include "tests/unit/foliage/rooms.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

std::vector<LightMapPlace> place_at(const glm::vec3& position, float clearance = 0) {
    LightMapPlace place;
    place.position = position;
    place.clearance_m = clearance;
    return {place};
}

PatchScene closed_box(float half) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_box(scene, glm::vec3(0), half);
    return scene;
}

void make_bark(PatchScene& scene) {
    for (Patch& patch : scene.patches)
        patch.kind = PatchKind::bark;
}

SideRadiance uniform_sides(std::size_t patches, const glm::vec3& front, const glm::vec3& back) {
    return {std::vector<glm::vec3>(patches, front), std::vector<glm::vec3>(patches, back)};
}

void expect_constant(const MapCoefficients& map, const glm::vec3& value) {
    const float unit = std::sqrt(4 * kPi);
    EXPECT_LT(glm::distance(map.at(0, 0), value * unit), 2e-5f * unit);
    for (std::size_t j = 1; j < map.count(); ++j)
        EXPECT_LT(glm::length(map.at(0, j)), 2e-5f) << j;
}

TEST(CapturedMaps, OfAConstantSkyAreConstant) {
    const PatchScene empty;
    const RayQueries queries(empty);
    const CapturedMaps maps(queries, {}, place_at({1, 2, 3}), 7, 968, silent_progress());
    MapCoefficients map(1, 7);
    maps.add_sky(cell_means(maps.directions(), constant_environment({0.5f, 1, 2}).remainder), map);
    expect_constant(map, {0.5f, 1, 2});
}

TEST(CapturedMaps, InAClosedRoomSeeItsWallsAndNoSky) {
    const PatchScene room = closed_box(1);
    const RayQueries queries(room);
    const CapturedMaps maps(queries, {}, place_at({0.3f, -0.2f, 0.1f}), 7, 968, silent_progress());
    MapCoefficients map(1, 7);
    maps.add_sky(cell_means(maps.directions(), constant_environment(glm::vec3(100)).remainder), map);
    maps.add_surfaces(uniform_sides(6, {1, 2, 3}, {9, 9, 9}), {}, map);
    expect_constant(map, {1, 2, 3});
}

TEST(CapturedMaps, SeeTheBackOfLeavesThatFaceAway) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0}); // above, front upwards
    const RayQueries queries(scene);
    const std::vector<CapturePoint> points = {{{0, 0, 0}, 0}, {{0, 2, 0}, 0}};
    const std::vector<glm::vec3> directions = {{0, 1, 0}, {0, -1, 0}};
    const Capture seen = capture(queries, {}, points, directions, silent_progress());
    EXPECT_EQ(seen.seen, (std::vector<std::uint32_t>{1, kSeesSky, kSeesSky, 0}));
    EXPECT_FLOAT_EQ(seen.distances[0], 1);
    EXPECT_EQ(seen.distances[1], std::numeric_limits<float>::infinity());
}

TEST(CapturedMaps, LookThroughHolesOfAlphaMasks) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-1, 1, -1}, {0, 0, 2}, {2, 0, 0});
    // u runs along x: the half with u < 0.5, x < 0, is solid
    for (const glm::vec3& position : scene.positions)
        scene.uvs.emplace_back((position.x + 1) / 2, (position.z + 1) / 2);
    scene.masks = {test::half_mask()};
    scene.triangle_mask.assign(scene.triangles.size(), 0);
    const RayQueries queries(scene);
    const std::vector<CapturePoint> points = {{{-0.5f, 0, 0.1f}, 0}, {{0.5f, 0, 0.1f}, 0}};
    const std::vector<glm::vec3> directions = {{0, 1, 0}};
    const Capture seen = capture(queries, {}, points, directions, silent_progress());
    EXPECT_EQ(seen.seen, (std::vector<std::uint32_t>{1, kSeesSky}));
}

TEST(CapturedMaps, LookOutOfTheWoodThatHoldsTheirPoint) {
    PatchScene scene = closed_box(0.1f); // fronts inwards: turn them outwards to make a piece of wood
    for (glm::uvec3& triangle : scene.triangles)
        std::swap(triangle.y, triangle.z);
    make_bark(scene);
    test::add_rectangle(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}); // a leaf above
    const RayQueries queries(scene);
    const std::vector<glm::vec3> up_and_down = {{0, 1, 0}, {0, -1, 0}};
    for (float clearance : {0.f, 0.05f, 0.2f}) { // inside the wood and past it
        const std::vector<CapturePoint> points = {{{0.01f, 0, 0.02f}, clearance}};
        const Capture seen = capture(queries, {}, points, up_and_down, silent_progress());
        EXPECT_EQ(seen.seen[0] / 2, 6u) << "sees the leaf";
        EXPECT_EQ(seen.seen[1], kSeesSky);
    }
    // From outside, the same wood is in the way.
    const std::vector<CapturePoint> below = {{{0.01f, -1, 0.02f}, 0}};
    const Capture seen = capture(queries, {}, below, up_and_down, silent_progress());
    EXPECT_LT(seen.seen[0] / 2, 6u);
    EXPECT_EQ(seen.seen[0] % 2, 0u) << "its front";
}

TEST(CapturedMaps, SeeTheGroundsCells) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2});
    scene.ground = Ground{0, glm::vec3(0.3f)};
    const RayQueries queries(scene);
    const GroundCells ground = make_ground_cells(scene);
    const CapturedMaps maps(queries, ground, place_at({0, 0.5f, 0}), 4, 200, silent_progress());
    MapCoefficients map(1, 4);
    maps.add_surfaces(uniform_sides(1, glm::vec3(0), glm::vec3(0)), std::vector<glm::vec3>(ground.size(), glm::vec3(1)),
                      map);
    EXPECT_NEAR(map.at(0, 0).r, 0.5f * std::sqrt(4 * kPi), 1e-4f); // half of what it sees is ground
    EXPECT_LT(map.at(0, sh_index(1, -1)).r, -0.5f);                // and that half is below
}

DistantLight light_from(const glm::vec3& direction, float half_angle) {
    DistantLight light;
    light.direction = glm::normalize(direction);
    light.half_angle = half_angle;
    light.irradiance = {4, 2, 1};
    return light;
}

TEST(ProjectedLights, OfADirectionAreItsHarmonics) {
    const DistantLight light = light_from({1, 2, -1}, 0);
    std::vector<double> harmonics(sh_count(7));
    evaluate_sh(7, glm::dvec3(light.direction), harmonics);
    const std::vector<glm::vec3> projected = project_light(light, 7);
    for (std::size_t j = 0; j < projected.size(); ++j)
        EXPECT_LT(glm::distance(projected[j], glm::vec3(4, 2, 1) * float(harmonics[j])), 1e-5f);
}

/// The disc's radiance E / (pi sin^2 a) times harmonics, summed over a fine grid of directions.
TEST(ProjectedLights, OfADiscAgreeWithQuadrature) {
    for (float half_angle : {0.02f, 0.3f, 1.2f, 2.5f}) {
        const DistantLight light = light_from({1, 2, -1}, half_angle);
        const CaptureDirections fine = make_capture_directions(1, 400'000);
        // What lies behind the surface that faces the disc gives it no light.
        const double in_front = std::min(double(half_angle), kPiDouble / 2);
        const double radiance = 4 / (kPiDouble * std::pow(std::sin(in_front), 2));
        std::vector<double> sums(sh_count(7), 0.0), y(sh_count(7));
        double weight = 0;
        for (std::size_t k = 0; k < fine.size(); ++k)
            if (glm::dot(fine.directions[k], light.direction) > std::cos(half_angle)) {
                evaluate_sh(7, glm::dvec3(fine.directions[k]), y);
                weight += fine.solid_angles[k];
                for (std::size_t j = 0; j < y.size(); ++j)
                    sums[j] += fine.solid_angles[k] * y[j];
            }
        const double true_cap = 2 * kPiDouble * (1 - std::cos(double(half_angle)));
        const std::vector<glm::vec3> projected = project_light(light, 7);
        for (std::size_t j = 0; j < sums.size(); ++j)
            EXPECT_NEAR(projected[j].r, sums[j] * radiance * true_cap / weight, 0.02) << half_angle << ' ' << j;
    }
}

TEST(ProjectedLights, OfTinyAndZeroDiscsAgree) {
    const std::vector<glm::vec3> zero = project_light(light_from({1, 2, -1}, 0), 7);
    for (float half_angle : {1e-6f, 1e-4f, 2e-4f, 1e-3f}) {
        const std::vector<glm::vec3> tiny = project_light(light_from({1, 2, -1}, half_angle), 7);
        for (std::size_t j = 0; j < zero.size(); ++j)
            EXPECT_LT(glm::distance(tiny[j], zero[j]), 1e-4f) << half_angle;
    }
}

TEST(CapturedMaps, HoldTheVisibleShareOfLights) {
    PatchScene scene;
    scene.optics.resize(1);
    test::add_rectangle(scene, {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}); // a roof over the first of two maps
    const RayQueries queries(scene);
    std::vector<LightMapPlace> places = place_at({0, 0, 0});
    places.push_back(place_at({50, 0, 0})[0]);
    const CapturedMaps maps(queries, {}, places, 7, 200, silent_progress());
    LightVisibility visibility(queries, maps.points(), 16, 1);
    Environment environment;
    environment.distant_lights = {light_from({0, 1, 0}, 0.01f)};
    environment.point_lights = {{"lamp", {0, 5, 0}, {25, 0, 0}}};
    MapCoefficients map(2, 7);
    maps.add_lights(environment, visibility, 1e-3f, map, silent_progress());
    for (std::size_t j = 0; j < map.count(); ++j)
        EXPECT_EQ(map.at(0, j), glm::vec3(0.f));
    const float lamp_at_the_second = 25.f / (50 * 50 + 25);
    EXPECT_NEAR(map.at(1, 0).r, (4 + lamp_at_the_second) / std::sqrt(4 * kPi), 1e-4f);
    EXPECT_NEAR(map.at(1, 0).g, 2 / std::sqrt(4 * kPi), 1e-4f);
}

TEST(LightVisibility, TracesOnlyLightsThatMoved) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    const RayQueries queries(small.scene);
    LightVisibility visibility(queries, {{{0, 2, 0}, 0}, {{0, 2.5f, 0}, 0}}, 16, 1);
    DistantLight sun = light_from({1, 2, 1}, 0.005f);
    const std::vector<float> first = visibility.of(sun, silent_progress());
    EXPECT_EQ(visibility.rays_traced(), 32u);
    sun.irradiance *= 7.f; // brighter is not elsewhere
    visibility.forget_unused();
    EXPECT_EQ(visibility.of(sun, silent_progress()), first);
    EXPECT_EQ(visibility.rays_traced(), 32u);
    sun.direction = glm::normalize(glm::vec3(-1, 2, 1));
    visibility.of(sun, silent_progress());
    EXPECT_EQ(visibility.rays_traced(), 64u);
}

TEST(Capture, DoesNotDependOnThreads) {
    const test::SmallTree small = test::ball_on_a_skeleton(300, 2, test::realistic_leaf());
    const RayQueries queries(small.scene);
    const std::vector<LightMapPlace> places = place_light_maps(small.tree, 9).places;
    set_thread_count(1);
    const CapturedMaps one(queries, {}, places, 7, 968, silent_progress());
    set_thread_count(2);
    const CapturedMaps two(queries, {}, places, 7, 968, silent_progress());
    set_thread_count(0);
    EXPECT_EQ(one.seen().seen, two.seen().seen);
    EXPECT_EQ(one.seen().distances, two.seen().distances);
}

} // namespace
} // namespace kokage

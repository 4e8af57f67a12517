#include "common/directions/spherical_harmonics.h"
#include "common/services/parallel.h"
#include "foliage/map_reading.h"
#include "tests/unit/foliage/small_trees.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

LightMapPlace sphere_of_two_metres() {
    LightMapPlace place;
    place.position = {10, 5, -3};
    place.radius_m = 2;
    return place;
}

// Eqs 2 and 3 of [F]: the same leaf, moved through the sphere, turns round.
TEST(EquationsTwoAndThree, JustOutsideReadsTowardsTheMapJustInsideTheAntipode) {
    const LightMapPlace place = sphere_of_two_metres();
    const glm::vec3 away = glm::normalize(glm::vec3(1, -2, 0.5f));
    const glm::vec3 outside = reading_direction(place, place.position + 2.0001f * away);
    const glm::vec3 inside = reading_direction(place, place.position + 1.9999f * away);
    EXPECT_LT(glm::distance(outside, -away), 1e-5f) << "outside: along the line from the leaf to the map";
    EXPECT_LT(glm::distance(inside, away), 1e-5f) << "inside: from the leaf's own side";
    EXPECT_LT(glm::length(outside + inside), 1e-5f);
}

// The antipode in the angles that the paper prints, (theta - pi, pi - phi), with theta the azimuth and phi the polar
// angle.
TEST(EquationsTwoAndThree, PrintedAnglesAreTheAntipode) {
    const LightMapPlace place = sphere_of_two_metres();
    Random random(1);
    for (int i = 0; i < 100; ++i) {
        const glm::vec3 d = test::random_direction(random); // from the leaf to the map
        const float theta = std::atan2(d.x, d.z) - kPi, phi = kPi - std::acos(d.y);
        const glm::vec3 printed(std::sin(phi) * std::sin(theta), std::cos(phi), std::sin(phi) * std::cos(theta));
        EXPECT_LT(glm::distance(reading_direction(place, place.position - d), printed), 1e-5f);
    }
}

/// A map that is red where +X is and blue where -X is.
MapCoefficients two_coloured_map() {
    MapCoefficients map(1, 2);
    const float unit = 1 / std::sqrt(3 / (4 * kPi));
    map.add(0, sh_index(0, 0), glm::vec3(1.f) * std::sqrt(4 * kPi));
    map.add(0, sh_index(1, 1), glm::vec3(1, 0, -1) * unit); // 1 + x, 1, 1 - x
    return map;
}

TEST(EquationsTwoAndThree, ALeafBetweenTheMapAndTheRedSideSeesRedOnlyFromInside) {
    LightMapPlace place;
    place.radius_m = 1;
    const MapCoefficients map = two_coloured_map();
    const std::vector<LightMapPlace> places = {place};
    EXPECT_LT(glm::distance(mean_of_maps_at(places, map, {0.99f, 0, 0}), glm::vec3(2, 1, 0)), 1e-5f);
    EXPECT_LT(glm::distance(mean_of_maps_at(places, map, {1.01f, 0, 0}), glm::vec3(0, 1, 2)), 1e-5f);
}

TEST(EquationFour, IsTheMeanOverAllMaps) {
    const std::vector<LightMapPlace> places(3);
    MapCoefficients maps(3, 1);
    for (std::size_t i = 0; i < 3; ++i)
        maps.add(i, 0, glm::vec3(float(i + 1)) * std::sqrt(4 * kPi));
    EXPECT_LT(glm::distance(mean_of_maps_at(places, maps, {5, 0, 0}), glm::vec3(2.f)), 1e-5f);
}

TEST(MapReading, AtTheMapsOwnPlaceItIsTheMapsMean) {
    const MapCoefficients map = two_coloured_map();
    const std::vector<LightMapPlace> places(1);
    EXPECT_LT(glm::distance(mean_of_maps_at(places, map, glm::vec3(0.f)), glm::vec3(1.f)), 1e-5f);
}

TEST(MapReading, WithoutMapsThereIsNoLight) {
    EXPECT_EQ(mean_of_maps_at({}, MapCoefficients(0, 7), {1, 2, 3}), glm::vec3(0.f));
}

TEST(MapReading, ManyPointsAtOnceAgreeWithOneByOne) {
    const test::SmallTree small = test::ball_on_a_skeleton(700, 2, test::realistic_leaf());
    std::vector<LightMapPlace> places = place_light_maps(small.tree, 37).places;
    std::vector<glm::vec3> points;
    for (const Leaf& leaf : small.tree.leaves)
        points.push_back(leaf.centre);
    points.push_back(places[5].position);
    for (int bands : {1, 2, 3, 5, 7, 8, 12, 40}) {
        MapCoefficients maps(places.size(), bands);
        Random random(1);
        for (std::size_t map = 0; map < places.size(); ++map)
            for (std::size_t j = 0; j < maps.count(); ++j)
                maps.add(map, j, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
        const std::vector<glm::vec3> fast = mean_of_maps(places, maps, points);
        for (std::size_t i = 0; i < points.size(); ++i)
            ASSERT_LT(glm::distance(fast[i], mean_of_maps_at(places, maps, points[i])), 2e-5f * float(bands))
                << bands << ' ' << i;
    }
}

TEST(MapReading, DoesNotDependOnThreads) {
    const test::SmallTree small = test::ball_on_a_skeleton(700, 2, test::realistic_leaf());
    const std::vector<LightMapPlace> places = place_light_maps(small.tree, 10).places;
    MapCoefficients maps(places.size(), 7);
    Random random(1);
    for (std::size_t map = 0; map < places.size(); ++map)
        for (std::size_t j = 0; j < maps.count(); ++j)
            maps.add(map, j, glm::vec3(random.uniform(-1, 1)));
    std::vector<glm::vec3> points;
    for (const Leaf& leaf : small.tree.leaves)
        points.push_back(leaf.centre);
    set_thread_count(1);
    const std::vector<glm::vec3> one = mean_of_maps(places, maps, points);
    set_thread_count(2);
    EXPECT_EQ(one, mean_of_maps(places, maps, points));
    set_thread_count(0);
}

} // namespace
} // namespace kokage

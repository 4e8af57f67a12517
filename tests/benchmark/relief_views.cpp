#include "tests/benchmark/relief_views.h"
#include "common/services/random.h"
#include "common/types.h"
#include "tests/benchmark/relief_maps.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

const ReliefScale kViewScale{glm::vec2(1.f), kBenchReliefDepth};

} // namespace

ReliefView plane_view(float degrees, int side, unsigned seed) {
    constexpr float tiles = 3;
    ReliefView view{"plane-" + std::to_string(int(std::lround(degrees))), side, side, {}, {}, {}};
    Random random(seed);
    const float angle = glm::radians(degrees), azimuth = 2 * kPi * random.uniform();
    const glm::vec2 across(std::cos(azimuth), std::sin(azimuth)), along(-across.y, across.x);
    const glm::vec3 direction(across * std::sin(angle), -std::cos(angle));
    const glm::vec2 corner(random.uniform(), random.uniform());
    view.rays.reserve(std::size_t(side) * std::size_t(side));
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::vec2 place = glm::vec2(float(x) + random.uniform(), float(y) + random.uniform()) / float(side);
            view.pixels.push_back(std::uint32_t(y * side + x));
            view.rays.push_back(relief_ray(corner + tiles * ((place.x - 0.5f) * along + (place.y - 0.5f) * across),
                                           direction, kViewScale));
        }
    return view;
}

ReliefView sphere_view(int side, int around) {
    ReliefView view{"sphere", side, side, {}, {}, {}};
    // One tile at the equator is 2π/around of the sphere's radius, in both directions.
    const float tile = 2 * kPi / float(around);
    const glm::vec3 ray(0, 0, -1); // the eye is at +z, y is up
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const glm::vec2 place = 2.f * (glm::vec2(float(x), float(y)) + 0.5f) / float(side) - 1.f;
            const float rest = 1 - glm::dot(place, place);
            if (rest <= 0)
                continue;
            const glm::vec3 normal(place, std::sqrt(rest));
            const float cosine = std::max(std::sqrt(normal.x * normal.x + normal.z * normal.z), 1e-3f);
            const glm::vec3 east(normal.z / cosine, 0, -normal.x / cosine), south = glm::cross(east, normal);
            const glm::vec2 coordinate(std::atan2(normal.x, normal.z) / tile, std::acos(normal.y) / tile);
            ReliefScale scale = kViewScale;
            scale.tile_m.x = cosine; // tiles get narrower towards the poles
            view.frames.push_back({east, south, normal, scale});
            view.pixels.push_back(std::uint32_t(y * side + x));
            view.rays.push_back(
                relief_ray(coordinate, {glm::dot(ray, east), glm::dot(ray, south), glm::dot(ray, normal)}, scale));
        }
    return view;
}

std::vector<ReliefView> benchmark_views(int side) {
    std::vector<ReliefView> views;
    unsigned seed = 1;
    for (const float degrees : {10.f, 25.f, 40.f, 55.f, 70.f, 85.f})
        views.push_back(plane_view(degrees, side, seed++));
    views.push_back(sphere_view(side));
    return views;
}

} // namespace kokage

// The coarse map of skylight in a crown against rays.
#include "common/services/random.h"
#include "trees/growth/sky_light.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

std::vector<glm::vec3> points_in_ball(int count) {
    Random random(5);
    std::vector<glm::vec3> points;
    while (points.size() < std::size_t(count)) {
        const float x = random.uniform(-1, 1), y = random.uniform(-1, 1), z = random.uniform(-1, 1);
        if (x * x + y * y + z * z < 1)
            points.emplace_back(3 * x, 10 + 3 * y, 3 * z);
    }
    return points;
}

TEST(SkyLight, IsFullWithoutLeavesAndComesFromAbove) {
    const SkyLight open(points_in_ball(100), 0.0), empty({}, 10.0);
    for (const SkyLight* light : {&open, &empty})
        for (const glm::vec3& place : {glm::vec3(0, 10, 0), glm::vec3(2, 9, -1), glm::vec3(50, -3, 7)}) {
            EXPECT_NEAR(light->relative(place), 1, 1e-4);
            // Mean direction of an evenly bright hemisphere: half up.
            EXPECT_NEAR(light->direction(place).y, 0.5, 0.02);
            EXPECT_NEAR(glm::length(light->direction(place)), 0.5, 0.03);
        }
}

// A ball of radius R that is filled evenly with leaf area density d: along a ray of length s through it, exp(-d s / 2)
// comes through (leaves face all ways). Integrated over many directions of the sky.
TEST(SkyLight, AgreesWithRaysThroughAnEvenBall) {
    const double leaf_area = 120, radius = 3, density = leaf_area / (4.0 / 3 * kPiDouble * radius * radius * radius);
    const SkyLight light(points_in_ball(60000), leaf_area);
    for (const glm::dvec3& place :
         {glm::dvec3(0, 10, 0), glm::dvec3(0, 11.5, 0), glm::dvec3(1.5, 9.5, 1), glm::dvec3(-2, 10, 0.5)}) {
        Random random(9);
        double sum = 0;
        glm::dvec3 direction_sum(0.0);
        constexpr int rays = 20000;
        for (int i = 0; i < rays; ++i) {
            const double y = random.uniform_double(), azimuth = 2 * kPiDouble * random.uniform_double(),
                         r = std::sqrt(1 - y * y);
            const glm::dvec3 d(r * std::cos(azimuth), y, r * std::sin(azimuth)), o = place - glm::dvec3(0, 10, 0);
            const double b = glm::dot(o, d),
                         way = -b + std::sqrt(std::max(0.0, b * b - glm::dot(o, o) + radius * radius));
            const double through = std::exp(-0.5 * density * way);
            sum += through / rays;
            direction_sum += through / rays * d;
        }
        EXPECT_NEAR(light.relative(glm::vec3(place)), sum, 0.1 * sum + 0.01);
        const glm::vec3 expected(direction_sum / sum), found = light.direction(glm::vec3(place));
        EXPECT_LT(glm::distance(expected, found), 0.08) << found.x << " " << found.y << " " << found.z;
    }
}

// Neighbours are a level layer around the box that the own foliage stands in: a ray meets it from where it leaves the
// box up to the layer's top.
TEST(SkyLight, AgreesWithRaysThroughALayerOfNeighbours) {
    constexpr double density = 0.4, base = 8, top = 16;
    const std::vector<glm::vec3> points = points_in_ball(20000);
    glm::dvec3 low(1e9), high(-1e9);
    for (const glm::vec3& p : points) {
        low = glm::min(low, glm::dvec3(p));
        high = glm::max(high, glm::dvec3(p));
    }
    const SkyLight light(points, 0.0, {density, float(base), float(top)});
    for (const glm::dvec3& place : {glm::dvec3(0, 7.5, 0), glm::dvec3(0, 10, 0), glm::dvec3(2, 12, -1)}) {
        Random random(9);
        double sum = 0;
        constexpr int rays = 20000;
        for (int i = 0; i < rays; ++i) {
            const double y = random.uniform_double(), azimuth = 2 * kPiDouble * random.uniform_double(),
                         r = std::sqrt(1 - y * y);
            const glm::dvec3 d(r * std::cos(azimuth), y, r * std::sin(azimuth));
            double out = 1e9;
            for (glm::length_t k = 0; k < 3; ++k)
                out = std::min(out, ((d[k] > 0 ? high[k] : low[k]) - place[k]) / d[k]);
            const double within = std::max(0.0, top - std::max(base, place.y + out * y)) / std::max(y, 1e-9);
            sum += std::exp(-0.5 * density * within) / rays;
        }
        EXPECT_LT(sum, 0.75);
        EXPECT_NEAR(light.relative(glm::vec3(place)), sum, 0.1 * sum + 0.02);
    }
    const SkyLight alone(points, 0.0, {0.0, float(base), float(top)});
    EXPECT_NEAR(alone.relative({0, 7.5f, 0}), 1, 1e-4);
}

TEST(SkyLight, MoreLeavesNeverMeanMoreLight) {
    const std::vector<glm::vec3> points = points_in_ball(3000);
    float before = 1.1f;
    for (const double leaf_area : {1.0, 10.0, 100.0, 1000.0, 1e9}) {
        const float here = SkyLight(points, leaf_area).relative({0.3f, 9.5f, 0});
        EXPECT_LT(here, before);
        EXPECT_GE(here, 0.f);
        before = here;
    }
}

} // namespace
} // namespace kokage

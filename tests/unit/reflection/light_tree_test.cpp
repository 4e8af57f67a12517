#include "common/directions/lobes.h"
#include "common/directions/sphere_sets.h"
#include "common/services/random.h"
#include "reflection/maps/light_tree.h"

#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

LobeBounds bounds_of(LobeKind kind, double wide, double narrow) {
    auto shape = [&](double parameter) { return float(kind == LobeKind::phong ? parameter : ggx_falloff(parameter)); };
    return {kind, float(lobe_value({kind, narrow}, 0)), shape(wide), shape(narrow)};
}

struct LobePair {
    LobeKind kind;
    double wide, narrow;
};
const std::vector<LobePair> kLobes = {
    {LobeKind::ggx, 1, 1},         {LobeKind::ggx, 0.5, 0.5},     {LobeKind::ggx, 0.2, 0.15},
    {LobeKind::ggx, 0.05, 0.05},   {LobeKind::phong, 2, 2},       {LobeKind::phong, 5, 8},
    {LobeKind::phong, 1000, 1700}, {LobeKind::phong, 5000, 5000}, {LobeKind::phong, 2.5, 2.6},
};

TEST(LightTree, BoundsHoldForTheLobesThatAreMeantAtAllLargerDistances) {
    for (const LobePair& pair : kLobes) {
        const LobeBounds bounds = bounds_of(pair.kind, pair.wide, pair.narrow);
        for (const double parameter : {pair.wide, pair.narrow}) {
            auto f = [&](double d) { return lobe_value({pair.kind, parameter}, d * d); };
            LobeBounds::Change largest{0, 0, 0};
            for (double d = 1.41; d >= 0; d -= 0.0005) { // from far to near: the largest so far
                const double h = 1e-5, value = f(d), slope = (f(d + h) - f(std::abs(d - h))) / (2 * h),
                             curvature = (f(d + h) - 2 * value + f(std::abs(d - h))) / (h * h);
                largest.value = std::max(largest.value, float(value));
                if (d > h)
                    largest.slope = std::max(largest.slope, float(std::abs(slope)));
                largest.curvature = std::max(largest.curvature, float(std::abs(curvature)));
                const LobeBounds::Change bound = bounds.from(float(d));
                const float noise = 1e-4f * bounds.peak; // of the differences
                ASSERT_LE(largest.value, 1.0001f * bound.value + 1e-6f * bounds.peak) << parameter << " at " << d;
                ASSERT_LE(largest.slope, 1.001f * bound.slope + noise) << parameter << " at " << d;
                ASSERT_LE(largest.curvature, 1.001f * bound.curvature + noise) << parameter << " at " << d;
            }
        }
    }
    EXPECT_TRUE(std::isinf(bounds_of(LobeKind::phong, 0.3, 1).from(0.5f).slope)) << "an edge at the horizon";
}

ClusterOfLight cluster_with(std::size_t count, float radius, std::uint64_t seed) {
    Random random(seed);
    const glm::vec3 axis =
        glm::normalize(glm::vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)));
    ClusterOfLight cluster;
    cluster.axis = axis;
    glm::vec3 sum(0);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec3 offset(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        // Colours change across the light, so that no channel has its middle where another has.
        cluster.points.push_back({glm::normalize(axis + radius * offset),
                                  glm::vec3(0.1f + (offset.x > 0 ? 1.f : 0.f), random.uniform(), 0.5f) / float(count)});
        cluster.chord = std::max(cluster.chord, glm::distance(axis, cluster.points.back().direction));
        sum += cluster.points.back().irradiance;
    }
    cluster.strength = std::max({sum.r, sum.g, sum.b});
    return cluster;
}

glm::dvec3 seen(const std::vector<PointOfLight>& points, const Lobe& lobe, const glm::vec3& direction) {
    glm::dvec3 sum(0);
    for (const PointOfLight& point : points) {
        const glm::dvec3 apart = glm::dvec3(point.direction) - glm::dvec3(direction);
        sum += glm::dvec3(point.irradiance) * lobe_value(lobe, glm::dot(apart, apart));
    }
    return sum;
}

TEST(LightTree, WhatIsGatheredAddsWhatThePointsDo) {
    std::size_t all = 0, gathered_points = 0;
    for (const LobePair& pair : kLobes)
        for (const float radius : {0.02f, 0.3f, 1.5f}) {
            const ClusterOfLight cluster = cluster_with(700, radius, std::uint64_t(1000 * radius));
            const LightTree tree(cluster);
            const LobeBounds bounds = bounds_of(pair.kind, pair.wide, pair.narrow);
            for (const glm::dvec3& axis : fibonacci_sphere(60).directions) {
                Random random(7);
                std::vector<PointOfLight> points;
                const float chord = 0.05f, error = 1e-5f;
                tree.gather(glm::vec3(axis), chord, 2, bounds, error, points);
                all += cluster.points.size();
                gathered_points += points.size();
                for (int i = 0; i < 4; ++i) {
                    const glm::vec3 offset(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
                    const glm::vec3 texel = glm::normalize(glm::vec3(axis) + 0.5f * chord / 1.74f * offset);
                    for (const double parameter : {pair.wide, pair.narrow}) {
                        const Lobe lobe{pair.kind, parameter};
                        const glm::dvec3 off = glm::abs(seen(points, lobe, texel) - seen(cluster.points, lobe, texel));
                        const double allowed = double(error) * double(points.size()) + 3e-6 * double(bounds.peak);
                        EXPECT_LE(std::max({off.r, off.g, off.b}), allowed) << parameter << ", radius " << radius;
                    }
                }
            }
        }
    EXPECT_LT(gathered_points, all / 3);
}

TEST(LightTree, WithoutRoomForErrorEveryPointStandsForItself) {
    const ClusterOfLight cluster = cluster_with(100, 0.2f, 3);
    const LightTree tree(cluster);
    std::vector<PointOfLight> points;
    tree.gather(cluster.axis, 0.1f, 2, bounds_of(LobeKind::ggx, 0.5, 0.5), 0, points);
    EXPECT_EQ(points.size(), 100u);
    points.clear();
    tree.gather(cluster.axis, 0.1f, 2, bounds_of(LobeKind::phong, 0.3, 0.3), 1, points); // no bounds
    EXPECT_EQ(points.size(), 100u);
    points.clear();
    tree.gather(-cluster.axis, 0.1f, 0.5f, bounds_of(LobeKind::ggx, 0.5, 0.5), 1, points); // out of reach
    EXPECT_TRUE(points.empty());
    points.clear();
    LightTree(ClusterOfLight{}).gather({0, 1, 0}, 0.1f, 2, bounds_of(LobeKind::ggx, 0.5, 0.5), 1, points);
    EXPECT_TRUE(points.empty());
}

} // namespace
} // namespace kokage

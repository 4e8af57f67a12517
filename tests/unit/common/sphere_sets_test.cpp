#include "common/directions/sphere_sets.h"
#include "common/directions/spherical_harmonics.h"

#include <cmath>
#include <gtest/gtest.h>
#include <numeric>
#include <set>

using namespace kokage;

namespace {

double sum(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Largest error of integrating any harmonic up to a degree.
double worst_integral(const DirectionSet& set, int degree) {
    std::vector<double> integral(sh_count(degree + 1)), values(sh_count(degree + 1));
    for (std::size_t i = 0; i < set.directions.size(); ++i) {
        evaluate_sh(degree + 1, set.directions[i], values);
        for (std::size_t k = 0; k < values.size(); ++k)
            integral[k] += set.weights[i] * values[k];
    }
    integral[0] -= std::sqrt(4 * kPiDouble);
    double worst = 0;
    for (const double value : integral)
        worst = std::max(worst, std::abs(value));
    return worst;
}

void expect_sound(const DirectionSet& set, std::size_t count, double total) {
    ASSERT_EQ(set.directions.size(), count);
    ASSERT_EQ(set.weights.size(), count);
    EXPECT_NEAR(sum(set.weights), total, 1e-10);
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_NEAR(glm::length(set.directions[i]), 1, 1e-12);
        ASSERT_GT(set.weights[i], 0);
    }
}

TEST(SphereSets, Fibonacci) {
    for (int n : {1, 2, 10, 1000}) {
        expect_sound(fibonacci_sphere(n), std::size_t(n), 4 * kPiDouble);
    }
    EXPECT_LT(worst_integral(fibonacci_sphere(1000), 6), 2e-3);
    // Nearest neighbours keep their distance: 3.09 / sqrt(n) or so.
    const DirectionSet set = fibonacci_sphere(500);
    for (std::size_t a = 0; a < 500; ++a)
        for (std::size_t b = 0; b < a; ++b)
            ASSERT_GT(glm::distance(set.directions[a], set.directions[b]), 2.5 / std::sqrt(500.0));
    EXPECT_THROW(fibonacci_sphere(0), std::invalid_argument);
}

TEST(SphereSets, RingsAreExactToTheirDegreeAndNoFurther) {
    for (int degree : {0, 1, 2, 5, 12, 40}) {
        const DirectionSet set = gauss_rings(degree);
        expect_sound(set, std::size_t((degree / 2 + 1) * (degree + 1)), 4 * kPiDouble);
        EXPECT_LT(worst_integral(set, degree), 1e-12) << degree;
        EXPECT_GT(worst_integral(set, degree + 2), 1e-3) << degree;
    }
    EXPECT_THROW(gauss_rings(-1), std::invalid_argument);
}

TEST(SphereSets, DomesHaveTheirVerticesAndAreas) {
    for (int k : {1, 2, 3, 9, 18}) {
        const GeodesicDome dome = geodesic_dome(k);
        expect_sound(dome, std::size_t(10 * k * k + 2), 4 * kPiDouble);
        ASSERT_EQ(dome.triangles.size(), std::size_t(20 * k * k));
        std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
        for (const glm::uvec3& t : dome.triangles) {
            const glm::dvec3 &a = dome.directions[t.x], &b = dome.directions[t.y], &c = dome.directions[t.z];
            ASSERT_GT(glm::dot(a, glm::cross(b, c)), 0); // counter-clockwise from outside
            for (const auto& edge : {std::pair(t.x, t.y), {t.y, t.z}, {t.z, t.x}})
                ASSERT_TRUE(edges.insert(edge).second); // each directed edge once: closed, no vertex twice
        }
        for (const auto& [a, b] : edges)
            ASSERT_TRUE(edges.count({b, a}));
    }
    const GeodesicDome dome = geodesic_dome(6);
    // Slow twin of the areas: which vertex is nearest to each of many points?
    std::vector<double> nearest(dome.directions.size());
    const DirectionSet points = fibonacci_sphere(200000);
    for (const glm::dvec3& p : points.directions) {
        std::size_t best = 0;
        for (std::size_t i = 1; i < dome.directions.size(); ++i)
            if (glm::dot(p, dome.directions[i]) > glm::dot(p, dome.directions[best]))
                best = i;
        nearest[best] += 4 * kPiDouble / 200000;
    }
    for (std::size_t i = 0; i < nearest.size(); ++i)
        EXPECT_NEAR(dome.weights[i], nearest[i], 0.03 * nearest[i]); // counting some 550 points a cell
    EXPECT_THROW(geodesic_dome(0), std::invalid_argument);
}

TEST(SphereSets, StratifiedCoversEvenlyForEveryCount) {
    for (int n : {1, 2, 3, 5, 16, 64, 100, 1001}) {
        expect_sound(stratified_sphere(n, 1), std::size_t(n), 4 * kPiDouble);
        const glm::dvec3 axis = glm::normalize(glm::dvec3(-0.3, 0.5, -0.8));
        const DirectionSet half = stratified_hemisphere(n, axis, 1);
        expect_sound(half, std::size_t(n), 2 * kPiDouble);
        for (const glm::dvec3& d : half.directions)
            ASSERT_GE(glm::dot(d, axis), -1e-12);
    }
    EXPECT_EQ(stratified_sphere(64, 5).directions, stratified_sphere(64, 5).directions);
    EXPECT_NE(stratified_sphere(64, 5).directions, stratified_sphere(64, 6).directions);
    EXPECT_THROW(stratified_sphere(0, 1), std::invalid_argument);
}

TEST(SphereSets, StratifiedIsUnbiasedAndLessNoisyThanChance) {
    // Means of all harmonics over many sets vanish, and the spread of a set's integral lies far below that of
    // independent directions.
    constexpr int sets = 2000, n = 30, degree = 3;
    std::vector<double> mean(sh_count(degree + 1)), square(sh_count(degree + 1)), values(sh_count(degree + 1));
    for (int s = 0; s < sets; ++s) {
        const DirectionSet set = stratified_sphere(n, std::uint64_t(s));
        std::vector<double> integral(values.size());
        for (std::size_t i = 0; i < set.directions.size(); ++i) {
            evaluate_sh(degree + 1, set.directions[i], values);
            for (std::size_t k = 0; k < values.size(); ++k)
                integral[k] += set.weights[i] * values[k];
        }
        for (std::size_t k = 0; k < values.size(); ++k) {
            mean[k] += integral[k] / sets;
            square[k] += integral[k] * integral[k] / sets;
        }
    }
    const double independent = 4 * kPiDouble / n; // variance of the integral of a normalised function
    for (std::size_t k = 1; k < values.size(); ++k) {
        EXPECT_NEAR(mean[k], 0, 5 * std::sqrt(square[k] / sets)) << k;
        EXPECT_LT(square[k], 0.5 * independent) << k;
    }
}

} // namespace

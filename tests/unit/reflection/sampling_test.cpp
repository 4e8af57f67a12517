#include "common/services/random.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <set>
#include <vector>

namespace kokage {
namespace {

TEST(Sampling, MultiJitteredPointsFillRowsColumnsAndCells) {
    for (std::uint32_t pattern : {0u, 1u, 0x9e3779b9u}) {
        std::set<int> rows, columns, cells;
        for (std::uint32_t i = 0; i < 64; ++i) {
            const glm::vec2 u = multi_jittered(i, 64, pattern);
            ASSERT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
            rows.insert(int(u.y * 64));
            columns.insert(int(u.x * 64));
            cells.insert(int(u.x * 8) * 8 + int(u.y * 8));
        }
        EXPECT_EQ(rows.size(), 64u);
        EXPECT_EQ(columns.size(), 64u);
        EXPECT_EQ(cells.size(), 64u);
    }
}

TEST(Sampling, AnyCountGivesPointsInTheSquareWithTheRightMean) {
    for (std::uint32_t count : {1u, 2u, 3u, 7u, 13u, 100u}) {
        glm::dvec2 mean(0.0);
        for (std::uint32_t pattern = 0; pattern < 2000; ++pattern)
            for (std::uint32_t i = 0; i < count; ++i) {
                const glm::vec2 u = multi_jittered(i, count, std::uint32_t(hash64(pattern)));
                ASSERT_TRUE(u.x >= 0 && u.x < 1 && u.y >= 0 && u.y < 1);
                mean += glm::dvec2(u) / (2000.0 * count);
            }
        EXPECT_NEAR(mean.x, 0.5, 0.02) << count;
        EXPECT_NEAR(mean.y, 0.5, 0.02) << count;
    }
}

/// How far the share of points in boxes at the origin is from their area, at most (star discrepancy, on a grid).
double discrepancy(const std::vector<glm::vec2>& points) {
    double most = 0;
    for (int i = 1; i <= 16; ++i)
        for (int j = 1; j <= 16; ++j) {
            int within = 0;
            for (const glm::vec2& p : points)
                within += p.x * 16 < float(i) && p.y * 16 < float(j);
            most = std::max(most, std::abs(double(within) / double(points.size()) - i * j / 256.));
        }
    return most;
}

TEST(Sampling, EvenlySpreadPointsAreEvenAfterAnyCountOfThem) {
    Random random(5);
    for (const std::uint32_t count : {8u, 30u, 100u, 300u}) {
        double even = 0, independent = 0;
        for (std::uint32_t pattern = 0; pattern < 20; ++pattern) {
            std::vector<glm::vec2> points, random_points;
            for (std::uint32_t k = 0; k < count; ++k) {
                points.push_back(evenly_spread(k, pattern));
                ASSERT_TRUE(points.back().x >= 0 && points.back().x < 1 && points.back().y >= 0 && points.back().y < 1);
                const float x = random.uniform();
                random_points.push_back({x, random.uniform()});
            }
            even += discrepancy(points);
            independent += discrepancy(random_points);
        }
        EXPECT_LT(even, (count < 50 ? 0.75 : 0.5) * independent) << count;
    }
    EXPECT_NE(evenly_spread(0, 1), evenly_spread(0, 2));
}

TEST(Sampling, StratifiedNumbersFillTheirStrata) {
    std::set<int> strata;
    for (std::uint32_t i = 0; i < 19; ++i)
        strata.insert(int(stratified(i, 19, 77) * 19));
    EXPECT_EQ(strata.size(), 19u);
}

TEST(Sampling, CosineDirectionsHaveTheMomentsOfACosine) {
    glm::dvec3 mean(0.0);
    double square = 0;
    const std::uint32_t count = 1 << 14;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 d = cosine_direction(multi_jittered(i, count, 3));
        ASSERT_NEAR(glm::length(d), 1, 1e-5f);
        mean += glm::dvec3(d) / double(count);
        square += double(d.y) * double(d.y) / count;
    }
    EXPECT_NEAR(mean.x, 0, 1e-3);
    EXPECT_NEAR(mean.y, 2.0 / 3, 1e-3); // ∫ cos² / π
    EXPECT_NEAR(mean.z, 0, 1e-3);
    EXPECT_NEAR(square, 0.5, 1e-3);
}

TEST(Sampling, PixelFilterIsTheBlackmanHarrisWindow) {
    // Compare the distribution with the window's own, integrated by brute force.
    auto window = [](double x) {
        const double t = 2 * kPiDouble * (x / 3 + 0.5);
        return 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2 * t) - 0.01168 * std::cos(3 * t);
    };
    std::vector<double> sums{0};
    for (int i = 0; i < 3000; ++i)
        sums.push_back(sums.back() + window(-1.5 + (i + 0.5) / 1000));
    for (double x : {-1.0, -0.5, -0.2, 0.0, 0.3, 0.8}) {
        const double share = sums[std::size_t(std::lround((x + 1.5) * 1000))] / sums.back();
        EXPECT_NEAR(double(pixel_filter_offset(float(share))), x, 2e-3);
    }
    EXPECT_GE(pixel_filter_offset(0), -1.5f);
    EXPECT_LE(pixel_filter_offset(1), 1.5f);
}

TEST(Sampling, CubicBSplineSumsToOneAndKeepsStraightLines) {
    for (float t : {0.f, 0.25f, 0.5f, 0.9f, 1.f}) {
        const glm::vec4 w = cubic_b_spline(t);
        EXPECT_NEAR(w.x + w.y + w.z + w.w, 1, 1e-6f);
        EXPECT_NEAR(-w.x + w.z + 2 * w.w, t, 1e-6f);
        EXPECT_GE(std::min(std::min(w.x, w.y), std::min(w.z, w.w)), 0.f);
    }
}

} // namespace
} // namespace kokage

#include "common/trace/path_numbers.h"

#include <gtest/gtest.h>
#include <set>

namespace kokage {
namespace {

/// Every elementary interval of 2^a x 2^b cells (a + b = log2 count) holds exactly one of the first `count` points: a
/// (0,2)-net.
bool is_net(const std::vector<glm::vec2>& points) {
    int bits = 0;
    while ((1u << bits) < points.size())
        ++bits;
    for (int a = 0; a <= bits; ++a) {
        std::set<std::pair<int, int>> cells;
        for (const glm::vec2& p : points)
            cells.emplace(int(p.x * float(1 << a)), int(p.y * float(1 << (bits - a))));
        if (cells.size() != points.size())
            return false;
    }
    return true;
}

std::vector<glm::vec2> points_of(std::uint64_t seed, int count, int dimension) {
    std::vector<glm::vec2> points;
    for (int i = 0; i < count; ++i) {
        PathNumbers numbers(seed, std::uint32_t(i));
        for (int d = 0; d < dimension; ++d)
            d % 2 == 0 ? numbers.skip() : (void)numbers.single();
        points.push_back(numbers.pair());
    }
    return points;
}

TEST(PathNumbers, PairsAloneAreThoseOfPaths) {
    for (const std::uint64_t seed : {0ull, 99ull})
        for (std::uint32_t index : {0u, 1u, 1000u}) {
            PathNumbers numbers(seed, index);
            EXPECT_EQ(numbers.pair(), SobolPairs(seed).at(index));
            EXPECT_EQ(numbers.pair(), SobolPairs(seed, 1).at(index));
        }
}

TEST(PathNumbers, EveryPairIsANet) {
    for (const std::uint64_t seed : {1ull, 2ull, 12345ull})
        for (const int dimension : {0, 1, 5, 7})
            for (const int count : {1, 2, 16, 64, 1024})
                EXPECT_TRUE(is_net(points_of(seed, count, dimension))) << seed << " " << dimension << " " << count;
}

TEST(PathNumbers, NetTestRefusesIndependentPoints) {
    EXPECT_FALSE(is_net(points_of(1, 64, 8))) << "the ninth dimension is made of independent numbers";
}

TEST(PathNumbers, SinglesAreStratified) {
    std::set<int> cells;
    for (std::uint32_t i = 0; i < 256; ++i) {
        PathNumbers numbers(9, i);
        numbers.skip();
        cells.insert(int(numbers.single() * 256));
    }
    EXPECT_EQ(cells.size(), 256u);
}

TEST(PathNumbers, EachNumberAloneIsUniformOverSeeds) {
    // chi^2 of 32 cells with 31 degrees of freedom: 99.99 % quantile is 70.
    for (const std::uint32_t index : {0u, 1u, 77u}) {
        std::array<int, 32> cells{};
        const int draws = 64000;
        for (int seed = 0; seed < draws; ++seed) {
            PathNumbers numbers(std::uint64_t(seed) * 977 + 3, index);
            numbers.skip();
            ++cells[std::size_t(numbers.pair().y * 32)];
        }
        double chi2 = 0;
        for (const int n : cells)
            chi2 += std::pow(n - draws / 32.0, 2) / (draws / 32.0);
        EXPECT_LT(chi2, 70);
    }
}

TEST(PathNumbers, DimensionsAndSeedsAreUncorrelated) {
    double between_dimensions = 0, between_seeds = 0;
    const int draws = 65536;
    for (int i = 0; i < draws; ++i) {
        PathNumbers a(1, std::uint32_t(i)), b(2, std::uint32_t(i));
        const glm::vec2 first = a.pair(), second = a.pair(), other = b.pair();
        between_dimensions += double(first.x - 0.5f) * double(second.x - 0.5f);
        between_seeds += double(first.x - 0.5f) * double(other.x - 0.5f);
    }
    // The standard deviation of the mean of products of independent numbers is 1/12/sqrt(draws) = 3.3e-4.
    EXPECT_LT(std::abs(between_dimensions / draws), 1.3e-3);
    EXPECT_LT(std::abs(between_seeds / draws), 1.3e-3);
}

} // namespace
} // namespace kokage

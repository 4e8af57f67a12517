#include "tests/benchmark/effort_curve.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

TEST(EffortCurve, follows_a_power_law_exactly) {
    // error = 0.8 cpu^-1/2 is a straight line in logarithms: any error between the points is hit exactly.
    std::vector<EffortPoint> points;
    for (double cpu : {0.1, 1.0, 7.0, 20.0, 300.0})
        points.push_back({cpu, 0.8 / std::sqrt(cpu)});
    for (double error : {2.0, 0.5, 0.06, 0.05}) {
        const auto cpu = cpu_at_error(points, error);
        ASSERT_TRUE(cpu) << error;
        EXPECT_NEAR(*cpu / ((0.8 / error) * (0.8 / error)), 1.0, 1e-12) << error;
    }
}

TEST(EffortCurve, extrapolates_nothing) {
    const std::vector<EffortPoint> points{{1, 0.1}, {4, 0.05}};
    EXPECT_FALSE(cpu_at_error(points, 0.11));
    EXPECT_FALSE(cpu_at_error(points, 0.049));
    EXPECT_DOUBLE_EQ(cpu_at_error(points, 0.1).value_or(0), 1.0);
    EXPECT_DOUBLE_EQ(cpu_at_error(points, 0.05).value_or(0), 4.0);
    EXPECT_FALSE(cpu_at_error({}, 0.1));
    EXPECT_FALSE(cpu_at_error({{1, 0.2}}, 0.1));
    EXPECT_EQ(cpu_at_error({{3, 0.2}}, 0.2), 3.0);
}

TEST(EffortCurve, order_of_the_points_does_not_matter) {
    EXPECT_EQ(cpu_at_error({{1, 0.2}, {4, 0.1}, {16, 0.05}}, 0.07),
              cpu_at_error({{16, 0.05}, {1, 0.2}, {4, 0.1}}, 0.07));
}

TEST(EffortCurve, a_curve_that_turns_back_is_charged_for_its_dearest_crossing) {
    // 0.1 is crossed between 1 and 2, left again, and reached for good between 4 and 8.
    const auto cpu = cpu_at_error({{1, 0.12}, {2, 0.09}, {4, 0.11}, {8, 0.05}}, 0.1);
    ASSERT_TRUE(cpu);
    EXPECT_GT(*cpu, 4.0);
    EXPECT_LT(*cpu, 8.0);
}

TEST(EffortCurve, equal_errors_and_useless_points_do_no_harm) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(cpu_at_error({{1, 0.1}, {2, 0.1}, {0, 0.3}, {nan, 0.01}, {5, nan}}, 0.1), 2.0);
}

} // namespace
} // namespace kokage

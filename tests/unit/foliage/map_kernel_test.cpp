#include "common/directions/legendre.h"
#include "common/types.h"
#include "foliage/map_kernel.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

/// The kernel as a function of the angle's cosine: sum of (2l+1)/(4pi) k_l P_l.
double kernel_at(const std::vector<double>& factors, double cosine) {
    std::vector<double> legendre(factors.size());
    legendre_polynomials(cosine, legendre);
    double sum = 0;
    for (std::size_t l = 0; l < factors.size(); ++l)
        sum += double(2 * l + 1) / (4 * kPiDouble) * factors[l] * legendre[l];
    return sum;
}

TEST(SquaredDirichletKernel, IsNowhereNegativeAndHasUnitMass) {
    for (int bands = 1; bands <= 40; ++bands) {
        const std::vector<double> factors = squared_dirichlet_factors(bands);
        EXPECT_EQ(factors[0], 1) << "unit mass";
        const double peak = kernel_at(factors, 1);
        for (int i = 0; i <= 2000; ++i)
            EXPECT_GE(kernel_at(factors, -1 + i / 1000.0), -1e-13 * peak) << bands;
    }
}

TEST(SquaredDirichletKernel, IsTheSquareOfADirichletKernel) {
    const std::vector<double> factors = squared_dirichlet_factors(7), four(4, 1.0);
    const double scale = kernel_at(factors, 1) / std::pow(kernel_at(four, 1), 2);
    for (double cosine : {-1.0, -0.7, -0.2, 0.1, 0.5, 0.93})
        EXPECT_NEAR(kernel_at(factors, cosine), scale * std::pow(kernel_at(four, cosine), 2), 1e-13);
}

TEST(ClampedCosine, FactorsAgreeWithQuadrature) {
    const std::vector<double> factors = clamped_cosine_factors(12);
    for (std::size_t l = 0; l < factors.size(); ++l) {
        double sum = 0; // 2pi times the integral of x P_l(x) over [0, 1], where it is a polynomial
        for (const QuadratureNode& node : gauss_legendre(20)) {
            const double x = 0.5 * (node.x + 1);
            std::vector<double> legendre(factors.size());
            legendre_polynomials(x, legendre);
            sum += 2 * kPiDouble * 0.5 * node.weight * x * legendre[l];
        }
        EXPECT_NEAR(factors[l], sum, 1e-13) << l;
    }
}

} // namespace
} // namespace kokage

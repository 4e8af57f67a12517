// The identities of real spherical harmonics.
#include "common/directions/legendre.h"
#include "common/directions/spherical_harmonics.h"
#include "common/services/random.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

glm::dvec3 random_direction(Random& random) {
    const double z = 2 * random.uniform_double() - 1, phi = 2 * kPiDouble * random.uniform_double();
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

/// The slow twin: textbook definition from the standard library's spherical Legendre functions.
double slow_sh(int l, int m, const glm::dvec3& d) {
    const double theta = std::atan2(std::hypot(d.x, d.y), d.z), phi = std::atan2(d.y, d.x);
    const int order = std::abs(m);
    // std::sph_legendre holds the Condon-Shortley phase (-1)^m: take it out.
    const double polar = std::sph_legendre(unsigned(l), unsigned(order), theta) * (order % 2 ? -1 : 1);
    if (m == 0)
        return polar;
    return std::sqrt(2.0) * polar * (m > 0 ? std::cos(order * phi) : std::sin(order * phi));
}

TEST(SphericalHarmonics, FirstBandsAreTheTextbookPolynomials) {
    const glm::dvec3 d = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    double v[9];
    evaluate_sh(3, d, v);
    const double c = std::sqrt(1 / (4 * kPiDouble));
    EXPECT_NEAR(v[0], c, 1e-15);
    EXPECT_NEAR(v[1], c * std::sqrt(3.0) * d.y, 1e-15);
    EXPECT_NEAR(v[2], c * std::sqrt(3.0) * d.z, 1e-15);
    EXPECT_NEAR(v[3], c * std::sqrt(3.0) * d.x, 1e-15);
    EXPECT_NEAR(v[4], c * std::sqrt(15.0) * d.x * d.y, 1e-15);
    EXPECT_NEAR(v[5], c * std::sqrt(15.0) * d.y * d.z, 1e-15);
    EXPECT_NEAR(v[6], c * std::sqrt(5.0) / 2 * (3 * d.z * d.z - 1), 1e-15);
    EXPECT_NEAR(v[7], c * std::sqrt(15.0) * d.x * d.z, 1e-15);
    EXPECT_NEAR(v[8], c * std::sqrt(15.0) / 2 * (d.x * d.x - d.y * d.y), 1e-15);
}

TEST(SphericalHarmonics, AgreesWithTheSlowDefinitionTo80Bands) {
    Random random(1);
    for (int bands : {1, 2, 7, 40, 64, 65, 80}) {
        std::vector<double> values(sh_count(bands));
        for (int i = 0; i < 10; ++i) {
            const glm::dvec3 d = random_direction(random);
            evaluate_sh(bands, d, values);
            for (int l = 0; l < bands; ++l)
                for (int m = -l; m <= l; ++m)
                    ASSERT_NEAR(values[sh_index(l, m)], slow_sh(l, m, d), 2e-12)
                        << "l " << l << " m " << m << " of " << bands;
        }
    }
}

TEST(SphericalHarmonics, FloatAgreesWithDouble) {
    Random random(2);
    for (int bands : {1, 7, 33, 40}) {
        std::vector<double> exact(sh_count(bands));
        std::vector<float> values(sh_count(bands));
        for (int i = 0; i < 20; ++i) {
            const glm::vec3 d = glm::vec3(random_direction(random)) * 1.0000002f;
            evaluate_sh(bands, glm::normalize(glm::dvec3(d)), exact);
            evaluate_sh(bands, d, values);
            for (std::size_t k = 0; k < values.size(); ++k)
                ASSERT_NEAR(values[k], exact[k], 1e-6) << k;
        }
    }
}

TEST(SphericalHarmonics, AreOrthonormal) {
    // Gauss-Legendre in z times equal steps in azimuth integrates products of two harmonics exactly.
    for (int bands : {1, 2, 7, 20}) {
        const std::size_t count = sh_count(bands);
        std::vector<double> gram(count * count), values(count);
        for (const QuadratureNode& node : gauss_legendre(bands))
            for (int j = 0; j < 2 * bands; ++j) {
                const double phi = 2 * kPiDouble * (j + 0.3) / (2 * bands), r = std::sqrt(1 - node.x * node.x);
                evaluate_sh(bands, glm::dvec3(r * std::cos(phi), r * std::sin(phi), node.x), values);
                for (std::size_t a = 0; a < count; ++a)
                    for (std::size_t b = 0; b < count; ++b)
                        gram[a * count + b] += node.weight * kPiDouble / bands * values[a] * values[b];
            }
        for (std::size_t a = 0; a < count; ++a)
            for (std::size_t b = 0; b < count; ++b)
                ASSERT_NEAR(gram[a * count + b], a == b ? 1 : 0, 1e-12) << a << " " << b << " of " << bands;
    }
}

TEST(SphericalHarmonics, AdditionTheoremHoldsTo512Bands) {
    // sum_m Y_lm(a) Y_lm(b) = (2l+1)/(4 pi) P_l(a.b)
    Random random(3);
    for (int bands : {1, 7, 40, 512}) {
        std::vector<double> at_a(sh_count(bands)), at_b(sh_count(bands)), legendre(std::size_t(bands), 0.0);
        for (int i = 0; i < 6; ++i) {
            glm::dvec3 a = random_direction(random), b = random_direction(random);
            if (i == 0)
                a = b;
            if (i == 1)
                a = {0, 0, 1}; // the pole
            if (i == 2)
                a = b = glm::normalize(glm::dvec3(1e-9, 2e-9, -1)); // next to the other one
            if (i == 3)
                a = glm::normalize(glm::dvec3(0.02, 0.01, 1)), b = glm::normalize(glm::dvec3(0.015, 0.02, 1));
            evaluate_sh(bands, a, at_a);
            evaluate_sh(bands, b, at_b);
            legendre_polynomials(std::min(1.0, glm::dot(a, b)), legendre);
            for (int l = 0; l < bands; ++l) {
                double sum = 0;
                for (int m = -l; m <= l; ++m)
                    sum += at_a[sh_index(l, m)] * at_b[sh_index(l, m)];
                const double scale = (2 * l + 1) / (4 * kPiDouble);
                ASSERT_NEAR(sum / scale, legendre[std::size_t(l)], 2e-10) << "l " << l << " pair " << i;
            }
        }
    }
}

TEST(SphericalHarmonics, SumsRadiance) {
    Random random(4);
    for (int bands : {1, 3, 40}) {
        std::vector<glm::vec3> coefficients(sh_count(bands));
        for (glm::vec3& c : coefficients)
            c = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
        const glm::dvec3 d = random_direction(random);
        std::vector<double> values(sh_count(bands));
        evaluate_sh(bands, d, values);
        glm::dvec3 expected(0);
        for (std::size_t i = 0; i < values.size(); ++i)
            expected += glm::dvec3(coefficients[i]) * values[i];
        const glm::vec3 sum = sh_radiance(coefficients, glm::vec3(d));
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[glm::length_t(c)], expected[glm::length_t(c)], 2e-5 * bands);
    }
}

TEST(SphericalHarmonics, RefusesWrongSizes) {
    std::vector<double> small(8);
    EXPECT_THROW(evaluate_sh(3, glm::dvec3(0, 0, 1), small), std::invalid_argument);
    EXPECT_THROW(sh_bands(8), std::invalid_argument);
    EXPECT_EQ(sh_bands(49), 7);
    EXPECT_EQ(sh_bands(0), 0);
}

TEST(Legendre, QuadratureIsExactForItsDegreeAndNoFurther) {
    for (int n : {1, 2, 3, 8, 33, 200}) {
        const auto nodes = gauss_legendre(n);
        ASSERT_EQ(nodes.size(), std::size_t(n));
        auto integral = [&](int power) {
            double sum = 0;
            for (const QuadratureNode& node : nodes)
                sum += node.weight * std::pow(node.x, power);
            return sum;
        };
        for (int power = 0; power <= 2 * n - 1; ++power)
            ASSERT_NEAR(integral(power), power % 2 ? 0 : 2.0 / (power + 1), 1e-13) << "n " << n << " power " << power;
        if (n <= 8) {
            EXPECT_GT(std::abs(integral(2 * n) - 2.0 / (2 * n + 1)), 1e-7);
        }
        for (std::size_t i = 1; i < nodes.size(); ++i)
            EXPECT_LT(nodes[i - 1].x, nodes[i].x);
    }
}

} // namespace

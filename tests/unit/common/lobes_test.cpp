// Zonal coefficients of lobes against quadrature, windows, and the theorem of Funk and Hecke.
#include "common/directions/legendre.h"
#include "common/directions/lobes.h"
#include "common/directions/sphere_sets.h"
#include "common/directions/window.h"
#include "common/directions/zonal.h"
#include "common/services/error.h"
#include "common/services/random.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

constexpr std::array<double, 3> hemispheres = {-1, 0, 1};
constexpr std::array<double, 2> kUpperHalf = {0, 1}, kWholeSphere = {-1, 1};

TEST(Lobes, CosineAgreesWithQuadratureForEveryBand) {
    for (int bands : {1, 2, 7, 40, 200}) {
        const auto k = cosine_lobe(bands), both = two_sided_cosine_lobe(bands);
        const auto slow = zonal_coefficients(
            bands, [](double t) { return std::max(t, 0.0); }, hemispheres, bands + 2);
        const auto slow_both = zonal_coefficients(
            bands, [](double t) { return std::abs(t); }, hemispheres, bands + 2);
        for (std::size_t l = 0; l < k.size(); ++l) {
            EXPECT_NEAR(k[l], slow[l], 1e-13) << l;
            EXPECT_NEAR(both[l], slow_both[l], 1e-13) << l;
        }
    }
    const auto k = cosine_lobe(5); // the figures of Ramamoorthi and Hanrahan 2001
    EXPECT_NEAR(k[0], 3.141593, 1e-6);
    EXPECT_NEAR(k[1], 2.094395, 1e-6);
    EXPECT_NEAR(k[2], 0.785398, 1e-6);
    EXPECT_EQ(k[3], 0);
    EXPECT_NEAR(k[4], -0.130900, 1e-6);
}

TEST(Lobes, PhongAgreesWithQuadrature) {
    for (double exponent : {0.0, 1.0, 2.0, 7.0, 32.0, 300.0}) {
        const auto k = phong_lobe(40, exponent);
        const auto slow = zonal_coefficients(
            40, [&](double t) { return (exponent + 1) / (2 * kPiDouble) * std::pow(t, exponent); }, kUpperHalf, 400);
        for (std::size_t l = 0; l < k.size(); ++l)
            EXPECT_NEAR(k[l], slow[l], 1e-12) << "exponent " << exponent << " l " << l;
    }
    // Broken exponents have a root at t = 0: t = s^n makes them smooth. Here (L = 0.3, 5.7) with s^10.
    for (double exponent : {0.3, 5.7}) {
        const auto k = phong_lobe(40, exponent);
        std::vector<double> slow(40), legendre(40);
        for (const QuadratureNode& node : gauss_legendre(400)) {
            const double s = 0.5 + 0.5 * node.x, t = std::pow(s, 10);
            legendre_polynomials(t, legendre);
            for (std::size_t l = 0; l < 40; ++l)
                slow[l] +=
                    0.5 * node.weight * 10 * std::pow(s, 9) * (exponent + 1) * std::pow(t, exponent) * legendre[l];
        }
        for (std::size_t l = 0; l < 40; ++l)
            EXPECT_NEAR(k[l], slow[l], 1e-12) << "exponent " << exponent << " l " << l;
    }
    for (const double value : phong_lobe(40, 1e5)) {
        EXPECT_GT(value, 0.99);
        EXPECT_LE(value, 1);
    }
}

TEST(Lobes, PhongWithExponentOneIsTheNormalisedCosine) {
    const auto phong = phong_lobe(40, 1), cosine = cosine_lobe(40);
    for (std::size_t l = 0; l < 40; ++l)
        EXPECT_NEAR(phong[l], cosine[l] / kPiDouble, 1e-15);
}

TEST(Lobes, PhongValueKeepsItsDigits) {
    for (double exponent : {1.0, 50.0, 1e5})
        for (double angle : {0.0, 1e-4, 0.01, 0.3, 1.5}) {
            const double chord = 2 * std::sin(0.5 * angle);
            const double exact = (exponent + 1) / (2 * kPiDouble) * std::pow(std::cos(angle), exponent);
            EXPECT_NEAR(phong_lobe_value(exponent, chord * chord), exact, 1e-9 * exact + 1e-300);
        }
    EXPECT_EQ(phong_lobe_value(3, 2.0), 0);
    EXPECT_EQ(phong_lobe_value(3, 3.9), 0);
    EXPECT_NEAR(phong_lobe_value(0, 1.9), 1 / (2 * kPiDouble), 1e-15);
}

/// Zonal coefficients by an independent road: long double, over w = 1 - t in pieces that double from the peak.
template <class Value>
std::vector<double> slow_coefficients(int bands, double narrowest, Value value) {
    std::vector<long double> borders{0};
    for (long double w = narrowest; w < 1; w *= 2)
        borders.push_back(w);
    for (long double rest = 0.25L; rest > 1e-30L; rest *= 0.25L) // a root at the right angle
        borders.push_back(1 - rest);
    borders.push_back(1);
    std::sort(borders.begin(), borders.end());
    const auto rule = gauss_legendre(300);
    std::vector<long double> k(static_cast<std::size_t>(bands));
    for (std::size_t piece = 1; piece < borders.size(); ++piece) {
        const long double half = 0.5L * (borders[piece] - borders[piece - 1]),
                          middle = 0.5L * (borders[piece] + borders[piece - 1]);
        for (const QuadratureNode& node : rule) {
            const long double w = middle + half * node.x, weight = half * node.weight * value(w);
            long double p = 1, before = 0;
            for (int l = 0; l < bands; ++l) {
                k[std::size_t(l)] += weight * p;
                const long double next = ((2 * l + 1) * (1 - w) * p - l * before) / (l + 1);
                before = p;
                p = next;
            }
        }
    }
    std::vector<double> normalised;
    for (const long double value_l : k)
        normalised.push_back(double(value_l / k[0]));
    return normalised;
}

TEST(Lobes, GgxAgreesWithQuadratureForEveryRoughness) {
    for (double roughness : {0.001, 0.01, 0.05, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 0.99, 1.0}) {
        // As the microfacet model has it: D of the half vector, whose squared cosine is (1+t)/2, times n.l.
        const long double alpha = (long double)(roughness)*roughness, a2 = alpha * alpha;
        const auto slow = slow_coefficients(300, 1e-14, [&](long double w) {
            const long double d = (1 - w / 2) * (a2 - 1) + 1;
            // the same, with the digits of the peak
            const long double exact = a2 * (1 - w / 2) + w / 2;
            EXPECT_NEAR(double(d / exact), 1, 1e-4 / double(a2) * 1e-14 + 1e-12);
            return a2 / (exact * exact) * (1 - w);
        });
        const auto k = ggx_lobe(300, roughness);
        for (std::size_t l = 0; l < k.size(); ++l)
            ASSERT_NEAR(k[l], slow[l], 1e-12) << "roughness " << roughness << " l " << l;
        double mass = 0; // of the value, by the same pieces
        const double x = ggx_falloff(roughness);
        for (double from = 0, to = std::min(1.0, 1e-3 / std::max(x, 1e-3));; from = to, to = std::min(1.0, 1.5 * to)) {
            for (const QuadratureNode& node : gauss_legendre(40)) {
                const double w = from + 0.5 * (to - from) * (1 + node.x);
                mass += 2 * kPiDouble * 0.5 * (to - from) * node.weight * ggx_lobe_value(roughness, 2 * w);
            }
            if (to >= 1)
                break;
        }
        EXPECT_NEAR(mass, 1, 1e-12) << roughness;
    }
}

TEST(Lobes, GgxIsTheCosineAtRoughnessOneAndTheMirrorAtZero) {
    const auto rough = ggx_lobe(100, 1), cosine = phong_lobe(100, 1);
    for (std::size_t l = 0; l < 100; ++l)
        EXPECT_NEAR(rough[l], cosine[l], 1e-13);
    for (double w : {0.0, 0.3, 0.9})
        EXPECT_NEAR(ggx_lobe_value(1, 2 * w), (1 - w) / kPiDouble, 1e-15);
    for (const double value : ggx_lobe(2048, 0))
        EXPECT_EQ(value, 1);
    for (const double value : ggx_lobe(2048, 0.001)) // a mirror to the eye
        EXPECT_NEAR(value, 1, 1e-4);
    EXPECT_EQ(ggx_lobe_value(0.5, 2.1), 0);
    EXPECT_TRUE(ggx_lobe(0, 0.5).empty());
}

TEST(Lobes, GgxsSmoothPartAgreesWithQuadratureAndIsTheWholeWithoutTheNearOne) {
    for (double roughness : {0.001, 0.02, 0.3, 1.0})
        for (double sharpest : {10.0, 20000.0}) {
            const long double alpha = (long double)(roughness)*roughness, u = 2 * alpha * alpha / (1 - alpha * alpha);
            long double sum = 0; // of the whole and of the smooth part
            const auto k = ggx_smooth_part(100, roughness, sharpest);
            const auto slow = slow_coefficients(100, 1e-14, [&](long double w) {
                if (roughness == 1)
                    return 1 - w;
                const long double b = (long double)(sharpest) * (u + w);
                // The integral of p exp(-p (u+w)) up to `sharpest`, where that keeps digits as a series.
                long double smooth = 0, term = b * b / 2;
                if (b > 1)
                    smooth = 1 - (1 + b) * std::exp(-b);
                else
                    for (int n = 2; n < 30; ++n, term *= -b / n)
                        smooth += (n - 1) * term;
                return (1 - w) * smooth / ((u + w) * (u + w));
            });
            for (std::size_t l = 0; l < k.size(); ++l)
                ASSERT_NEAR(k[l] / k[0], slow[l], 1e-12) << "roughness " << roughness << " l " << l;
            EXPECT_NEAR(ggx_smooth_share(roughness, sharpest), k[0], 1e-14) << roughness << " " << sharpest;
            // What is left is the near part, exp(-b) (1+b) of the whole, by the same pieces.
            const auto both = ggx_lobe(100, roughness);
            for (double from = 0, to = 1e-14;; from = to, to = std::min(1.0, 1.5 * to)) {
                for (const QuadratureNode& node : gauss_legendre(40)) {
                    const double w = from + 0.5 * (to - from) * (1 + node.x), b = sharpest * (double(u) + w);
                    if (roughness < 1)
                        sum += 2 * kPiDouble * 0.5 * (to - from) * node.weight * ggx_lobe_value(roughness, 2 * w) *
                               (1 + b) * std::exp(-b);
                }
                if (to >= 1)
                    break;
            }
            EXPECT_NEAR(double(sum), 1 - k[0], 1e-11);
            EXPECT_LE(k[99], both[99] + 1e-12);
        }
    EXPECT_LT(std::abs(ggx_smooth_part(400, 0.01, 1000)[399]), 1e-11 * ggx_smooth_share(0.01, 1000));
    EXPECT_TRUE(ggx_smooth_part(0, 0.5, 10).empty());
}

TEST(Lobes, PhongAgreesWithQuadratureUpToTheSmoothest) {
    for (double exponent : {0.3, 0.77, 1.0, 5.7, 63.9, 1234.5, 5000.0, 1e5}) {
        const auto k = phong_lobe(300, exponent);
        const auto slow =
            slow_coefficients(300, 1e-8, [&](long double w) { return std::pow(1 - w, (long double)exponent); });
        for (std::size_t l = 0; l < k.size(); ++l)
            ASSERT_NEAR(k[l], slow[l], 1e-12) << "exponent " << exponent << " l " << l;
    }
}

TEST(Lobes, ConeAgreesWithQuadrature) {
    for (double half_angle : {1e-9, 0.00465, 0.1, 1.0, 1.5707963267948966, 3.0, 3.141592653589793}) {
        const double c = std::cos(half_angle), height = 2 * std::pow(std::sin(0.5 * half_angle), 2);
        const std::array<double, 2> cap = {c, 1};
        const auto k = cone_lobe(40, half_angle);
        if (half_angle > 1e-3) {
            const auto slow = zonal_coefficients(
                40, [&](double) { return 1 / (2 * kPiDouble * height); }, cap, 60);
            for (std::size_t l = 0; l < 40; ++l)
                EXPECT_NEAR(k[l], slow[l], 1e-10) << half_angle << " l " << l;
        } else {
            for (const double value : k)
                EXPECT_NEAR(value, 1, 1e-12);
        }
    }
    for (const double value : cone_lobe(512, 0))
        EXPECT_EQ(value, 1);
}

TEST(Zonal, FunkHeckeAgreesWithQuadratureOverTheSphere) {
    // (f * h)(n) integrated point by point, against bands multiplied.
    constexpr int bands = 12;
    Random random(5);
    std::vector<double> f(sh_count(bands));
    for (double& c : f)
        c = random.uniform_double() - 0.5;
    auto h = [](double t) { return 0.3 + t * (0.5 + t * (0.7 - 0.2 * t)); }; // a cubic: the quadrature is exact
    const auto zonal = zonal_coefficients(bands, h, kWholeSphere, 20);
    std::vector<double> convolved = f;
    convolve_zonal(std::span<double>(convolved), std::span<const double>(zonal));
    const DirectionSet rings = gauss_rings(bands + 3);
    std::vector<double> harmonics(sh_count(bands));
    for (int i = 0; i < 20; ++i) {
        const glm::dvec3 n = glm::normalize(
            glm::dvec3(random.uniform_double() - 0.5, random.uniform_double() - 0.5, random.uniform_double() - 0.5));
        double slow = 0, fast = 0;
        for (std::size_t d = 0; d < rings.directions.size(); ++d) {
            evaluate_sh(bands, rings.directions[d], harmonics);
            double value = 0;
            for (std::size_t k = 0; k < f.size(); ++k)
                value += f[k] * harmonics[k];
            slow += rings.weights[d] * value * h(glm::dot(n, rings.directions[d]));
        }
        evaluate_sh(bands, n, harmonics);
        for (std::size_t k = 0; k < f.size(); ++k)
            fast += convolved[k] * harmonics[k];
        EXPECT_NEAR(fast, slow, 1e-12);
    }
}

TEST(Zonal, AddsALobeAroundADirection) {
    const glm::vec3 direction = glm::normalize(glm::vec3(1, -2, 0.5f));
    const auto phong = phong_lobe(30, 20);
    std::vector<glm::vec3> sum(sh_count(30), glm::vec3(0));
    add_zonal(sum, direction, {1, 2, 3}, phong);
    for (const glm::vec3& n : {direction, glm::normalize(glm::vec3(1, -1.5f, 0.5f)), -direction}) {
        const double exact = phong_lobe_value(20, glm::dot(n - direction, n - direction));
        EXPECT_NEAR(sh_radiance(sum, n).y, 2 * exact, 2e-4);
        EXPECT_NEAR(evaluate_zonal(phong, double(glm::dot(n, direction))), exact, 1e-4);
    }
}

TEST(Window, NonNegativeKernelsAreSoAndHaveUnitMass) {
    for (int bands = 1; bands <= 40; ++bands)
        for (const Window window : {Window::non_negative, Window::squared_dirichlet}) {
            const auto k = window_factors(window, bands);
            ASSERT_EQ(k.size(), std::size_t(bands));
            EXPECT_DOUBLE_EQ(k[0], 1);
            const double peak = evaluate_zonal(k, 1);
            for (int i = 0; i <= 20000; ++i)
                ASSERT_GE(evaluate_zonal(k, std::cos(kPiDouble * i / 20000)), -1e-13 * peak)
                    << window_name(window) << " bands " << bands;
            double mass = 0, mass_of_size = 0;
            for (const QuadratureNode& node : gauss_legendre(bands + 1)) {
                mass += 2 * kPiDouble * node.weight * evaluate_zonal(k, node.x);
                mass_of_size += 2 * kPiDouble * node.weight * std::abs(evaluate_zonal(k, node.x));
            }
            EXPECT_NEAR(mass, 1, 1e-12);
            EXPECT_NEAR(mass_of_size, 1, 1e-12);
            for (const double factor : k)
                EXPECT_LE(std::abs(factor), 1 + 1e-14); // no band grows
        }
}

TEST(Window, NonNegativeIsTheSharpest) {
    EXPECT_NEAR(window_factors(Window::squared_dirichlet, 7)[1], 0.75, 1e-12);          // (n-1)/n, n = 4
    EXPECT_NEAR(window_factors(Window::non_negative, 7)[1], 0.8611363115940526, 1e-12); // the largest root of P_4
    EXPECT_NEAR(window_factors(Window::non_negative, 3)[1], std::sqrt(1 / 3.0), 1e-12); // of P_2
    EXPECT_NEAR(window_factors(Window::non_negative, 2)[1], 1 / 3.0, 1e-12);            // 1 + t
    double before = 0;
    for (int bands = 2; bands <= 40; ++bands) { // more bands, sharper, odd degrees too
        const double k1 = window_factors(Window::non_negative, bands)[1];
        EXPECT_GT(k1, before);
        EXPECT_GE(k1, window_factors(Window::squared_dirichlet, bands)[1] - 1e-12);
        before = k1;
    }
}

TEST(Window, HannAndLanczosHaveTheirFormulas) {
    const auto hann = window_factors(Window::hann, 8), lanczos = window_factors(Window::lanczos, 8),
               none = window_factors(Window::none, 8);
    for (int l = 0; l < 8; ++l) {
        EXPECT_NEAR(hann[std::size_t(l)], std::pow(std::cos(kPiDouble * l / 16), 2), 1e-15);
        EXPECT_NEAR(lanczos[std::size_t(l)], l == 0 ? 1 : 8 * std::sin(kPiDouble * l / 8) / (kPiDouble * l), 1e-15);
        EXPECT_EQ(none[std::size_t(l)], 1);
    }
    EXPECT_TRUE(window_factors(Window::hann, 0).empty());
    for (const Window window :
         {Window::none, Window::hann, Window::lanczos, Window::non_negative, Window::squared_dirichlet})
        EXPECT_EQ(window_from_name(window_name(window)), window);
    EXPECT_THROW(window_from_name("blackman"), InputError);
}

} // namespace

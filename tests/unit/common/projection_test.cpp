#include "common/directions/legendre.h"
#include "common/directions/lobes.h"
#include "common/directions/projection.h"
#include "common/directions/ring_transform.h"
#include "common/directions/rotation.h"
#include "common/directions/sphere_sets.h"
#include "common/directions/zonal.h"
#include "common/environment/lat_long.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "tests/unit/common/random_image.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

glm::dmat3 some_rotation(double angle, const glm::dvec3& axis) {
    return glm::dmat3(glm::rotate(glm::dmat4(1), angle, glm::normalize(axis)));
}

using test::random_image;

/// The slow twin: every pixel cut into many parts, each sampled at its centre.
std::vector<glm::dvec3> slow_project(const Image& image, int bands, int parts) {
    std::vector<glm::dvec3> sum(sh_count(bands), glm::dvec3(0));
    std::vector<double> harmonics(sh_count(bands));
    const int width = image.width * parts, height = image.height * parts;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            evaluate_sh(bands, pixel_direction(x, y, width, height), harmonics);
            const float* p = image.at(x / parts, y / parts);
            const glm::dvec3 value = pixel_solid_angle(y, width, height) * glm::dvec3(p[0], p[1], p[2]);
            for (std::size_t k = 0; k < sum.size(); ++k)
                sum[k] += harmonics[k] * value;
        }
    return sum;
}

TEST(ShRotation, AgreesWithEvaluatingRotatedDirections) {
    Random random(1);
    for (int bands : {1, 2, 3, 7, 20, 40})
        for (const glm::dmat3& rotation :
             {glm::dmat3(1), some_rotation(0.7, {1, 2, -0.5}), some_rotation(kPiDouble, {1, 0, 0}),
              some_rotation(kPiDouble / 2, {0, 0, 1}), some_rotation(3, {0, 1, 1e-9})}) {
            const ShRotation sh_rotation(rotation, bands);
            std::vector<double> f(sh_count(bands)), harmonics(sh_count(bands));
            for (double& c : f)
                c = random.uniform_double() - 0.5;
            std::vector<double> rotated = f;
            sh_rotation.apply(std::span<double>(rotated));
            for (int i = 0; i < 10; ++i) {
                const glm::dvec3 d = glm::normalize(glm::dvec3(
                    random.uniform_double() - 0.5, random.uniform_double() - 0.5, random.uniform_double() - 0.5));
                double expected = 0, value = 0;
                evaluate_sh(bands, glm::transpose(rotation) * d, harmonics);
                for (std::size_t k = 0; k < f.size(); ++k)
                    expected += f[k] * harmonics[k];
                evaluate_sh(bands, d, harmonics);
                for (std::size_t k = 0; k < f.size(); ++k)
                    value += rotated[k] * harmonics[k];
                EXPECT_NEAR(value, expected, 1e-11 * bands) << bands;
            }
        }
}

TEST(ShRotation, MatricesAreOrthogonalAndCompose) {
    const glm::dmat3 a = some_rotation(1.1, {0.2, 1, 0.3}), b = some_rotation(-2.3, {1, -1, 0.5});
    const ShRotation first(a, 40), second(b, 40), both(b * a, 40);
    for (int l = 0; l < 40; ++l) {
        const auto identity = Eigen::MatrixXd::Identity(2 * l + 1, 2 * l + 1);
        EXPECT_LT((first.matrix(l) * first.matrix(l).transpose() - identity).cwiseAbs().maxCoeff(), 1e-11) << l;
        EXPECT_LT((second.matrix(l) * first.matrix(l) - both.matrix(l)).cwiseAbs().maxCoeff(), 1e-11) << l;
    }
    EXPECT_THROW(
        {
            std::vector<double> more(sh_count(41));
            first.apply(std::span<double>(more));
        },
        std::invalid_argument);
}

TEST(ProjectLatLong, WhiteFurnace) {
    // A white sphere: L00 = sqrt(4 pi), all else 0, at every resolution and number of bands; the irradiance of any
    // surface is pi.
    for (const auto& [width, height] : {std::pair(1, 1), {2, 1}, {3, 5}, {17, 9}, {256, 128}, {16384, 4}})
        for (int bands : {1, 2, 7, 40}) {
            Image white(width, height, 3);
            std::fill(white.pixels.begin(), white.pixels.end(), 1.f);
            std::vector<glm::vec3> c = project_lat_long(white, bands);
            EXPECT_NEAR(c[0].x, std::sqrt(4 * kPiDouble), 1e-7 * std::sqrt(4 * kPiDouble)) << width << " x " << height;
            for (std::size_t i = 1; i < c.size(); ++i)
                ASSERT_NEAR(glm::length(c[i]), 0, 1e-7) << width << " x " << height << " coefficient " << i;
            const auto cosine = cosine_lobe(bands);
            convolve_zonal(std::span<glm::vec3>(c), std::span<const double>(cosine));
            EXPECT_NEAR(sh_radiance(c, glm::normalize(glm::vec3(1, 2, 3))).y, kPiDouble, 1e-6);
        }
}

TEST(ProjectLatLong, AgreesWithTheSlowSum) {
    for (const auto& [width, height, parts] : {std::tuple(1, 1, 400), {8, 4, 60}, {6, 3, 80}, {31, 7, 16}, {64, 32, 8}})
        for (int bands : {1, 4, 12}) {
            const Image image = random_image(width, height, 9);
            const auto fast = project_lat_long(image, bands);
            const auto slow = slow_project(image, bands, parts);
            for (std::size_t i = 0; i < fast.size(); ++i)
                EXPECT_LT(glm::distance(glm::dvec3(fast[i]), slow[i]), 2e-3)
                    << width << " x " << height << " bands " << bands << " i " << i;
        }
}

TEST(ProjectLatLong, ConvergesToTheSlowSumAsItIsRefined) {
    const Image image = random_image(5, 3, 4); // a width that the FFT is not used for, with 12 bands
    const auto fast = project_lat_long(image, 12);
    double before = 1;
    for (int parts : {20, 40, 80}) {
        const auto slow = slow_project(image, 12, parts);
        double largest = 0;
        for (std::size_t i = 0; i < fast.size(); ++i)
            largest = std::max(largest, glm::distance(glm::dvec3(fast[i]), slow[i]));
        EXPECT_LT(largest, 0.3 * before) << parts; // second order: a quarter for each doubling
        before = largest;
    }
    EXPECT_LT(before, 1e-3);
}

TEST(ProjectLatLong, FindsALightWhereItIs) {
    // One bright pixel: the smoothed image is brightest in its direction. This ties the image's convention to the
    // harmonics' axes.
    for (const auto& [x, y] : {std::pair(10, 20), {63, 5}, {40, 30}, {0, 16}}) {
        Image image(64, 32, 3);
        image.at(x, y)[1] = 1;
        const auto c = project_lat_long(image, 20);
        const glm::vec3 d(pixel_direction(x, y, 64, 32));
        const float at_light = sh_radiance(c, d).y;
        EXPECT_GT(at_light, 0);
        EXPECT_NEAR(at_light, pixel_solid_angle(y, 64, 32) * 400 / (4 * kPiDouble),
                    0.1 * double(at_light)); // sum (2l+1)/(4 pi)
        EXPECT_LT(sh_radiance(c, -d).y, 0.2f * at_light);
        EXPECT_LT(sh_radiance(c, {d.y, d.z, d.x}).y, 0.3f * at_light);
    }
}

TEST(ProjectLatLong, SameBitsWithAnyNumberOfThreads) {
    const Image image = random_image(128, 64, 2);
    set_thread_count(1);
    const auto one = project_lat_long(image, 20);
    set_thread_count(2);
    const auto two = project_lat_long(image, 20);
    set_thread_count(0);
    EXPECT_EQ(one, two);
}

TEST(ProjectLatLong, ExtremeRadianceStaysFinite) {
    for (const float value : {0.f, 1e-30f, 1e30f}) {
        Image image(32, 16, 3);
        image.at(3, 4)[0] = value;
        for (const glm::vec3& c : project_lat_long(image, 40))
            ASSERT_TRUE(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z));
    }
    EXPECT_THROW(project_lat_long(Image(), 3), std::invalid_argument);
}

/// c_lm of ring_transform.h as real coefficients in world axes: taken at (x, z, y), real part of m, -imaginary of -m.
std::vector<glm::dvec3> ring_coefficients(const Image& image, int bands) {
    RingCoefficients coefficients(bands);
    RingAnalysis(image.width, image.height, bands).transform(image, 1, coefficients);
    std::vector<glm::dvec3> swapped(sh_count(bands), glm::dvec3(0.0));
    for (int l = 0; l < bands; ++l)
        for (int m = 0; m <= l; ++m) {
            const int parity = (l - m) % 2, i = (l - m) / 2, padded = coefficients.padded(m, parity);
            for (int channel = 0; channel < 3; ++channel) {
                const float* values = coefficients.values(m, parity) + channel * padded + i;
                const auto c = glm::length_t(channel);
                swapped[sh_index(l, m)][c] = double(values[0]);
                if (m > 0)
                    swapped[sh_index(l, -m)][c] = -double(values[3 * padded]);
            }
        }
    return swapped;
}

/// The slow way from those axes to the world's: f(x, y, z) = g(x, z, y), projected at many directions.
std::vector<glm::dvec3> with_y_and_z_swapped(const std::vector<glm::dvec3>& coefficients, int bands) {
    const std::size_t count = sh_count(bands);
    std::vector<glm::dvec3> result(count, glm::dvec3(0.0));
    std::vector<double> here(count), there(count);
    // Gauss-Legendre x even azimuths: exact for products of so many bands.
    const int around = 2 * bands + 1;
    for (const QuadratureNode& node : gauss_legendre(bands + 1))
        for (int k = 0; k < around; ++k) {
            const double azimuth = 2 * kPiDouble * k / around, sine = std::sqrt(1 - node.x * node.x);
            const glm::dvec3 d(sine * std::cos(azimuth), sine * std::sin(azimuth), node.x);
            evaluate_sh(bands, d, here);
            evaluate_sh(bands, glm::dvec3(d.x, d.z, d.y), there);
            glm::dvec3 value(0.0);
            for (std::size_t i = 0; i < count; ++i)
                value += there[i] * coefficients[i];
            for (std::size_t i = 0; i < count; ++i)
                result[i] += node.weight * 2 * kPiDouble / around * here[i] * value;
        }
    return result;
}

/// Each pixel as k x k pixels of the same colour.
Image split_pixels(const Image& image, int k) {
    Image result(k * image.width, k * image.height, 3);
    for (int y = 0; y < result.height; ++y)
        for (int x = 0; x < result.width; ++x)
            std::copy_n(image.at(x / k, y / k), 3, result.at(x, y));
    return result;
}

// The two ways from an image to harmonics: pixels integrated, in double (this one), and pixels as points at their
// centres, in float, for hundreds of bands in milliseconds (ring_transform.h). Where pixels are split into smaller ones
// of the same colour the second nears the first, by the square of their size.
TEST(ProjectLatLong, IsWhatTheRingTransformNearsAsPixelsAreSplit) {
    const int bands = 9;
    const Image image = random_image(12, 6, 3);
    const auto integrated = project_lat_long(image, bands);
    const auto difference = [&](int k) {
        const auto at_centres = with_y_and_z_swapped(ring_coefficients(split_pixels(image, k), bands), bands);
        double largest = 0;
        for (std::size_t i = 0; i < integrated.size(); ++i)
            largest = std::max(largest, glm::distance(at_centres[i], glm::dvec3(integrated[i])));
        return largest;
    };
    const double coarse = difference(1), fine = difference(4), finer = difference(16), finest = difference(64);
    EXPECT_GT(coarse, 0.02);
    EXPECT_LT(fine, 0.1 * coarse);
    EXPECT_LT(finer, 0.1 * fine);
    EXPECT_LT(finest, 1e-4);
}

struct Samples {
    std::vector<glm::vec3> directions, values;
    std::vector<double> weights;
};

Samples sample_function(const DirectionSet& set, const std::vector<glm::vec3>& coefficients) {
    Samples samples;
    for (const glm::dvec3& d : set.directions) {
        samples.directions.emplace_back(d);
        samples.values.push_back(sh_radiance(coefficients, glm::vec3(d)));
    }
    samples.weights = set.weights;
    return samples;
}

TEST(ProjectSamples, QuadratureGivesTheCoefficientsBack) {
    Random random(3);
    std::vector<glm::vec3> exact(sh_count(7));
    for (glm::vec3& c : exact)
        c = {random.uniform(), random.uniform(-1, 1), random.uniform()};
    const Samples on_rings = sample_function(gauss_rings(12), exact);
    const auto projected = project_samples(on_rings.directions, on_rings.values, on_rings.weights, 7);
    for (std::size_t i = 0; i < exact.size(); ++i)
        EXPECT_LT(glm::distance(projected[i], exact[i]), 2e-5f);
}

TEST(FitSamples, AnyDirectionsGiveTheCoefficientsBack) {
    Random random(4);
    std::vector<glm::vec3> exact(sh_count(5));
    for (glm::vec3& c : exact)
        c = {random.uniform(), random.uniform(-1, 1), random.uniform()};
    const Samples scattered = sample_function(stratified_sphere(60, 7), exact);
    const auto fitted = fit_samples(scattered.directions, scattered.values, {}, 5);
    const auto weighted = fit_samples(scattered.directions, scattered.values, scattered.weights, 5);
    for (std::size_t i = 0; i < exact.size(); ++i) {
        EXPECT_LT(glm::distance(fitted[i], exact[i]), 5e-4f);
        EXPECT_LT(glm::distance(weighted[i], exact[i]), 5e-4f);
    }
    EXPECT_THROW(fit_samples(std::span(scattered.directions).first(24), std::span(scattered.values).first(24), {}, 5),
                 std::invalid_argument);
    const std::vector<glm::vec3> same(60, glm::vec3(0, 0, 1));
    EXPECT_THROW(fit_samples(same, scattered.values, {}, 5), std::invalid_argument);
    EXPECT_THROW(fit_samples(same, std::span(scattered.values).first(3), {}, 5), std::invalid_argument);
}

} // namespace

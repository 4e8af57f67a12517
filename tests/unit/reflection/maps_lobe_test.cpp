// Lobes of reflection maps: values, reach, bands; discs through a lobe; the scale of roughness.
#include "common/directions/lobes.h"
#include "common/directions/zonal.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/maps/lobe.h"
#include "reflection/maps/lobe_over_cone.h"
#include "reflection/maps/roughness_scale.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

using namespace kokage;

namespace {

constexpr double kExponents[] = {0.3, 1, 7.5, 60, 1e3, 5000, 1e5};
constexpr double kRoughness[] = {1, 0.7, 0.4, 0.1, 0.02};

std::vector<Lobe> lobes() {
    std::vector<Lobe> all;
    for (double exponent : kExponents)
        all.push_back({LobeKind::phong, exponent});
    for (double roughness : kRoughness)
        all.push_back({LobeKind::ggx, roughness});
    return all;
}

TEST(MapLobe, NamesGoBothWays) {
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx})
        EXPECT_EQ(lobe_kind_from_name(lobe_kind_name(kind)), kind);
    EXPECT_THROW(lobe_kind_from_name("Phong"), InputError);
}

TEST(MapLobe, ReachIsWhereTheShareIsReached) {
    for (const Lobe& lobe : lobes())
        for (double share : {0.9, 0.5, 1e-3, 1e-17}) {
            const double reach = lobe_reach(lobe, share), peak = lobe_value(lobe, 0);
            ASSERT_GT(reach, 0);
            ASSERT_LE(reach, 2);
            // A hair's breadth to both sides: near the right angle the value's own digits end.
            EXPECT_GE(lobe_value(lobe, reach * (1 - 1e-12)), share * peak * (1 - 1e-6))
                << lobe.parameter << " " << share;
            EXPECT_LE(lobe_value(lobe, reach * (1 + 1e-12)), share * peak * (1 + 1e-6))
                << lobe.parameter << " " << share;
        }
    EXPECT_EQ(lobe_reach({LobeKind::phong, 0}, 0.5), 2);
    EXPECT_EQ(lobe_reach({LobeKind::ggx, 0.3}, 0), 2);
}

TEST(MapLobe, BandsAreThoseWhoseCoefficientsMatter) {
    for (const Lobe& lobe : lobes())
        for (double tolerance : {1e-2, 1e-5}) {
            const int bands = lobe_bands(lobe, tolerance, 1024);
            const auto k = lobe_coefficients(lobe, 1024);
            int needed = 1024;
            while (needed > 1 && std::abs(k[std::size_t(needed) - 1]) < tolerance)
                --needed;
            EXPECT_EQ(bands, needed) << lobe_kind_name(lobe.kind) << " " << lobe.parameter;
        }
}

/// The obvious twin: points of the cone, many.
double cone_by_points(const Lobe& lobe, double angle, double half_angle, int points) {
    double sum = 0;
    for (int i = 0; i < points; ++i) {
        const double theta = half_angle * (i + 0.5) / points;
        for (int j = 0; j < 4 * points; ++j) {
            const double phi = 2 * kPiDouble * (j + 0.5) / (4 * points);
            // the cone's axis is +z, the lobe's is in the x-z plane
            const glm::dvec3 point(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            const glm::dvec3 between = point - glm::dvec3(std::sin(angle), 0, std::cos(angle));
            sum += std::sin(theta) * lobe_value(lobe, glm::dot(between, between));
        }
    }
    return sum * half_angle * 2 * kPiDouble / (4.0 * points * points);
}

TEST(MapLobe, OverConesAgreesWithPoints) {
    for (const Lobe& lobe : {Lobe{LobeKind::phong, 0.3}, Lobe{LobeKind::phong, 12.5}, Lobe{LobeKind::phong, 150},
                             Lobe{LobeKind::ggx, 0.8}, Lobe{LobeKind::ggx, 0.5}})
        for (double half_angle : {0.00465, 0.1, 1.0, 2.0, 3.0})
            for (double angle : {0.0, 0.003, 0.05, 0.5, 1.5, 2.2, 3.14159}) {
                const double exact = lobe_over_cone(lobe, angle, half_angle);
                EXPECT_NEAR(exact, cone_by_points(lobe, angle, half_angle, 200), 5e-3 * exact + 2e-5)
                    << lobe_kind_name(lobe.kind) << " " << lobe.parameter << " disc " << half_angle << " at " << angle;
            }
}

TEST(MapLobe, OverConesAgreesWithZonalSums) {
    // A smooth lobe and a smooth disc: both series converge.
    const Lobe lobe{LobeKind::phong, 40};
    const auto k = lobe_coefficients(lobe, 600), cone = cone_lobe(600, 0.7);
    std::vector<double> both(600);
    for (std::size_t l = 0; l < 600; ++l)
        both[l] = k[l] * cone[l];
    const double solid_angle = 4 * kPiDouble * std::pow(std::sin(0.35), 2);
    for (double angle : {0.0, 0.2, 0.7, 1.1, 1.9})
        EXPECT_NEAR(lobe_over_cone(lobe, angle, 0.7), evaluate_zonal(both, std::cos(angle)) * solid_angle, 1e-10);
    for (const Lobe& whole : lobes()) { // the whole sphere, a hemisphere around the lobe
        EXPECT_NEAR(lobe_over_cone(whole, 1.0, kPiDouble), 1, 1e-10) << whole.parameter;
        EXPECT_NEAR(lobe_over_cone(whole, 0.0, kPiDouble / 2), 1, 1e-10) << whole.parameter;
        EXPECT_NEAR(lobe_over_cone(whole, kPiDouble / 2, kPiDouble / 2), 0.5, 1e-10) << whole.parameter; // a half
    }
}

TEST(MapLobe, LightsShrinkToTheirDirection) {
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.1, 1, 0.05));
    for (const Lobe& lobe : {Lobe{LobeKind::phong, 30}, Lobe{LobeKind::ggx, 0.4}}) {
        DistantLight bare, disc;
        bare.irradiance = disc.irradiance = {1, 2, 3};
        disc.half_angle = 1e-4f;
        const glm::dvec3 from_bare = light_through_lobe(bare, lobe, direction),
                         from_disc = light_through_lobe(disc, lobe, direction);
        const glm::dvec3 between = direction - glm::dvec3(0, 1, 0);
        EXPECT_NEAR(from_bare.y, 2 * lobe_value(lobe, glm::dot(between, between)), 1e-12);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(from_disc[c], from_bare[c], 1e-6 * from_bare[c]);
        // A disc over the whole sphere with radiance 5 shows 5 anywhere: its facing surface gets 5 pi.
        DistantLight everywhere;
        everywhere.half_angle = kPi;
        everywhere.irradiance = glm::vec3(5 * kPi);
        EXPECT_NEAR(light_through_lobe(everywhere, lobe, direction).x, 5, 1e-5);
        DistantLight region; // the same light cut into texels
        region.texels.push_back({{0, 1, 0}, {1, 2, 3}, 1e-4f});
        EXPECT_NEAR(light_through_lobe(region, lobe, direction).z, from_disc.z, 1e-6 * from_disc.z);
    }
}

TEST(RoughnessScale, MeetsThePapersFigures) {
    const RoughnessScale scale = RoughnessScale::solved(128);
    EXPECT_NEAR(scale.u(), 6.03, 0.005);
    EXPECT_NEAR(scale.exponent(1), 5000, 1e-8);
    // Eq 13 as it is printed.
    for (double smoothness : {0.05, 0.3, 0.77, 1.0}) {
        const double psi = std::atan(scale.u() / (smoothness * 128));
        EXPECT_NEAR(scale.exponent(smoothness), -std::log(256) / std::log(std::cos(psi)),
                    1e-9 * scale.exponent(smoothness));
        // what it means: at the angle of u voxels, the lobe has fallen to one of I levels
        EXPECT_NEAR(std::pow(std::cos(psi), scale.exponent(smoothness)), 1 / 256.0, 1e-9);
    }
    EXPECT_EQ(RoughnessScale::as_printed(128).u(), 6.2);
    EXPECT_NEAR(RoughnessScale::as_printed(128).exponent(1), 4733, 1);
    EXPECT_NEAR(RoughnessScale::solved(64, 256, 1000).exponent(1), 1000, 1e-9);
}

TEST(RoughnessScale, GoesBothWays) {
    for (int size : {1, 16, 128, 1024})
        for (double most : {50.0, 5000.0, 1e5}) {
            const RoughnessScale scale = RoughnessScale::solved(size, 256, most);
            double before = -1;
            for (double smoothness : {0.001, 0.01, 0.1, 0.25, 0.5, 0.75, 1.0}) {
                EXPECT_NEAR(scale.smoothness(scale.exponent(smoothness)), smoothness, 1e-9 * smoothness);
                EXPECT_GT(scale.exponent(smoothness), before);
                before = scale.exponent(smoothness);
            }
            EXPECT_EQ(scale.exponent(0), 0);
            EXPECT_EQ(scale.smoothness(0), 0);
        }
    EXPECT_THROW(RoughnessScale::solved(0), InputError);
    EXPECT_THROW(RoughnessScale::solved(128, 1), InputError);
    EXPECT_THROW(RoughnessScale::solved(128, 256, 0), InputError);
}

TEST(RoughnessScale, GltfRoughnessIsTheExponentThatFiltersMostAlike) {
    EXPECT_DOUBLE_EQ(exponent_from_roughness(1), 1);
    EXPECT_EQ(exponent_from_roughness(0), std::numeric_limits<double>::infinity());
    for (double roughness : {0.01, 0.1, 0.3, 0.6, 0.9, 1.0})
        EXPECT_NEAR(roughness_from_exponent(exponent_from_roughness(roughness)), roughness, 1e-12);
    EXPECT_EQ(roughness_from_exponent(0.5), 1);
    EXPECT_EQ(roughness_from_exponent(std::numeric_limits<double>::infinity()), 0);
    for (double roughness : {0.15, 0.3, 0.5, 0.8}) {
        const int bands = 600;
        const auto ggx = ggx_lobe(bands, roughness);
        const auto difference = [&](double exponent) {
            const auto phong = phong_lobe(bands, exponent);
            double sum = 0;
            for (std::size_t l = 1; l < std::size_t(bands); ++l)
                sum += (2.0 * double(l) + 1) / double(l * (l + 1)) * std::pow(ggx[l] - phong[l], 2);
            return sum;
        };
        const double exponent = exponent_from_roughness(roughness), least = difference(exponent);
        EXPECT_LT(least, difference(1.05 * exponent)) << roughness;
        EXPECT_LT(least, difference(0.95 * exponent)) << roughness;
    }
}

} // namespace

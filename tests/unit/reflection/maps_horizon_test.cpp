// The horizon's table against quadrature of the clipped lobe.
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/horizon.h"
#include "reflection/maps/lobe_over_cone.h"

#include <cmath>
#include <gtest/gtest.h>
#include <string>

using namespace kokage;

namespace {

glm::dvec3 direction_of_horizon(Random& random) {
    const double y = 2 * random.uniform_double() - 1, phi = 2 * kPiDouble * random.uniform_double();
    return {std::sqrt(1 - y * y) * std::cos(phi), y, std::sqrt(1 - y * y) * std::sin(phi)};
}

/// Hue round, saturation down (an 8-bit image's contrast), and blocks of random grey on it.
Environment patchy() {
    Environment environment;
    environment.remainder = Image(80, 40, 3);
    Random random(2);
    float grey[10][20];
    for (auto& row : grey)
        for (float& value : row)
            value = random.uniform();
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 80; ++x)
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] =
                    0.5f * grey[y / 4][x / 4] +
                    0.25f * (1 + std::cos(2 * kPi * (float(x) / 80 - float(c) / 3)) * float(y) / 40);
    return environment;
}

/// [R] eqs 1 and 2 with the horizon, over the lobe's full mass: every pixel.
glm::dvec3 clipped_by_brute_force(const Environment& environment, const Lobe& lobe, const glm::dvec3& mirrored,
                                  const glm::dvec3& normal) {
    const Image& image = environment.remainder;
    glm::dvec3 sum(0.0);
    double weights = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            // each pixel by 3 x 3 points, so that the horizon does not jump from centre to centre
            for (int j = 0; j < 3; ++j)
                for (int i = 0; i < 3; ++i) {
                    const glm::dvec3 light = pixel_direction(3 * x + i, 3 * y + j, 3 * image.width, 3 * image.height);
                    const glm::dvec3 between = light - mirrored;
                    const double weight = lobe_value(lobe, glm::dot(between, between)) *
                                          pixel_solid_angle(3 * y + j, 3 * image.width, 3 * image.height);
                    weights += weight;
                    if (glm::dot(light, normal) >= 0)
                        sum += weight * glm::dvec3(image.at(x, y)[0], image.at(x, y)[1], image.at(x, y)[2]);
                }
        }
    return sum / weights;
}

/// Mean error over random placements with the mirrored direction `elevation` above the horizon; 255 for 1.
double mean_error(const Environment& environment, const HorizonTable& table, const Lobe& lobe, double elevation,
                  int placements) {
    Random random(11);
    double error = 0;
    for (int i = 0; i < placements; ++i) {
        const glm::dvec3 normal = direction_of_horizon(random);
        const glm::dvec3 tangent = glm::normalize(glm::cross(normal, direction_of_horizon(random)));
        const glm::dvec3 mirrored = std::sin(elevation) * normal + std::cos(elevation) * tangent;
        const glm::dvec3 exact = clipped_by_brute_force(environment, lobe, mirrored, normal);
        const glm::vec3 fast = filtered_above_horizon(
            table, glm::vec3(normal), glm::vec3(mirrored), lobe.parameter, [&](const glm::vec3& d, float parameter) {
                return glm::vec3(filtered_by_brute_force(environment, {lobe.kind, double(parameter)}, glm::dvec3(d)));
            });
        for (int c = 0; c < 3; ++c)
            error += std::abs(double(fast[c]) - exact[c]);
    }
    return 255 * error / (3 * placements);
}

struct Case {
    LobeKind kind;
    double parameter, degrees;
    double at_least; ///< error without the correction
    double at_most;  ///< with two lookups
};

// Mean errors of 40 placements, 255 for 1: none / one lookup / two lookups.
//   Phong 0.3   at   1 and 30 degrees     62 / 1.2 / 1.0    38 / 1.3 / 1.1
//   Phong 3     at   1 and 10 degrees     62 / 1.2 / 0.8    47 / 1.2 / 0.9
//   Phong 20    at  -5, 1 and 10 degrees  84 / 1.3 / 0.7    61 / 1.6 / 0.9    28 / 1.4 / 0.9
//   Phong 120   at   1 degree             56 / 1.3 / 0.7
//   GGX 0.9, 0.6, 0.4 at 1 degree         62 / 1.1 / 0.9    61 / 1.2 / 0.9    61 / 1.4 / 1.0
constexpr Case kCases[] = {
    {LobeKind::phong, 0.3, 1, 30, 1.5}, {LobeKind::phong, 0.3, 30, 20, 1.7}, {LobeKind::phong, 3, 1, 30, 1.4},
    {LobeKind::phong, 3, 10, 20, 1.5},  {LobeKind::phong, 20, -5, 40, 0.8},  {LobeKind::phong, 20, 1, 30, 1.0},
    {LobeKind::phong, 20, 10, 10, 1.0}, {LobeKind::phong, 120, 1, 20, 1.3},  {LobeKind::ggx, 0.9, 1, 30, 1.4},
    {LobeKind::ggx, 0.6, 1, 30, 1.4},   {LobeKind::ggx, 0.4, 1, 30, 1.6},
};

TEST(Horizon, TakesOutWhatLiesBelowIt) {
    const Environment environment = patchy();
    for (const Case& at : kCases) {
        const Lobe lobe{at.kind, at.parameter};
        const double angle = at.degrees * kPiDouble / 180;
        const auto error = [&](HorizonCorrection correction) {
            return mean_error(environment, HorizonTable(at.kind, correction), lobe, angle, 8);
        };
        const double none = error(HorizonCorrection::none), one = error(HorizonCorrection::one_lookup),
                     two = error(HorizonCorrection::two_lookups);
        const std::string name = std::string(lobe_kind_name(at.kind)) + " " + std::to_string(at.parameter) + " at " +
                                 std::to_string(at.degrees) + ": " + std::to_string(none) + " / " +
                                 std::to_string(one) + " / " + std::to_string(two);
        EXPECT_GT(none, at.at_least) << name;
        EXPECT_LT(one, 2) << name;
        EXPECT_LT(two, at.at_most) << name;
    }
}

TEST(Horizon, ShareIsTheLobesMassAboveIt) {
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const HorizonTable table(kind);
        Random random(4);
        for (int i = 0; i < 400; ++i) {
            const double parameter = kind == LobeKind::phong ? 0.3 * std::pow(3e5, random.uniform_double())
                                                             : 0.05 + 0.95 * random.uniform_double();
            const double elevation = (random.uniform_double() - 0.3) * kPiDouble / 1.5;
            const glm::vec3 mirrored(std::cos(elevation), std::sin(elevation), 0);
            const HorizonLookup at = table.lookup({0, 1, 0}, mirrored, parameter);
            // By the arcs of a hemisphere, which lobe_over_cone's own tests hold against points.
            const double exact = lobe_over_cone({kind, parameter}, kPiDouble / 2 - elevation, kPiDouble / 2);
            EXPECT_NEAR(double(at.share), exact, 2e-3) << lobe_kind_name(kind) << " " << parameter << " " << elevation;
        }
    }
}

TEST(Horizon, FarFromItNothingChanges) {
    const glm::vec3 normal(0, 1, 0), up = glm::normalize(glm::vec3(0.01f, 1, 0));
    for (double parameter : {0.3, 5.0, 300.0, 1e5}) {
        const HorizonLookup at = HorizonTable(LobeKind::phong).lookup(normal, up, parameter);
        EXPECT_NEAR(at.share, 1, 5e-3);
        EXPECT_LT(glm::length(at.directions[0] - up), 5e-3f);
        EXPECT_NEAR(double(at.parameter), parameter, 0.03 * (parameter + 3));
    }
}

TEST(Horizon, NumbersStayFinite) {
    Random random(9);
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx})
        for (const HorizonCorrection correction :
             {HorizonCorrection::none, HorizonCorrection::one_lookup, HorizonCorrection::two_lookups}) {
            const HorizonTable table(kind, correction);
            for (int i = 0; i < 2000; ++i) {
                const double narrow = random.uniform_double();
                const double parameter =
                    kind == LobeKind::phong ? 1e-3 * std::pow(1e9, narrow) : std::pow(1e-4, narrow);
                const glm::vec3 normal(direction_of_horizon(random));
                const glm::vec3 mirrored = i % 3 == 0   ? normal
                                           : i % 3 == 1 ? -normal
                                                        : glm::vec3(direction_of_horizon(random));
                const HorizonLookup at = table.lookup(normal, mirrored, parameter);
                ASSERT_TRUE(at.count == 1 || at.count == 2);
                for (const glm::vec3& direction : at.directions)
                    ASSERT_NEAR(glm::length(direction), 1, 1e-4);
                ASSERT_GE(at.share, 0);
                ASSERT_LE(at.share, 1.0001f);
                ASSERT_TRUE(std::isfinite(at.parameter));
                if (kind == LobeKind::phong)
                    ASSERT_GE(at.parameter, float(parameter) * 0.999f);
                else
                    ASSERT_LE(at.parameter, float(parameter) * 1.001f);
                if (correction == HorizonCorrection::none) {
                    ASSERT_EQ(at.share, 1);
                    ASSERT_EQ(at.directions[0], mirrored);
                }
            }
        }
}

TEST(Horizon, NamesGoBothWays) {
    for (const HorizonCorrection correction :
         {HorizonCorrection::none, HorizonCorrection::one_lookup, HorizonCorrection::two_lookups})
        EXPECT_EQ(horizon_correction_from_name(horizon_correction_name(correction)), correction);
    EXPECT_THROW(horizon_correction_from_name("paper"), InputError);
}

} // namespace

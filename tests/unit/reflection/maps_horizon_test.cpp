// The horizon's table against quadrature of the clipped lobe.
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/horizon.h"

#include <cmath>
#include <cstdio>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

glm::dvec3 random_direction(Random& random) {
    const double y = 2 * random.uniform_double() - 1, phi = 2 * kPiDouble * random.uniform_double();
    return {std::sqrt(1 - y * y) * std::cos(phi), y, std::sqrt(1 - y * y) * std::sin(phi)};
}

/// Hue round, saturation down (an 8-bit image's contrast), and blocks of random grey on it.
Environment patchy() {
    Environment environment;
    environment.remainder = Image(160, 80, 3);
    Random random(2);
    float grey[10][20];
    for (auto& row : grey)
        for (float& value : row)
            value = random.uniform();
    for (int y = 0; y < 80; ++y)
        for (int x = 0; x < 160; ++x)
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] =
                    0.5f * grey[y / 8][x / 8] +
                    0.25f * (1 + std::cos(2 * kPi * (float(x) / 160 - float(c) / 3)) * float(y) / 80);
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
        const glm::dvec3 normal = random_direction(random);
        const glm::dvec3 tangent = glm::normalize(glm::cross(normal, random_direction(random)));
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

TEST(Horizon, ErrorsFallFromTheirUncorrectedSize) {
    const Environment environment = patchy();
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const HorizonTable none(kind, HorizonCorrection::none), one(kind, HorizonCorrection::one_lookup), two(kind);
        for (double parameter :
             kind == LobeKind::phong ? std::vector{0.3, 3.0, 20.0, 200.0} : std::vector{0.9, 0.6, 0.3})
            for (double degrees : {1.0, 10.0, 30.0, -5.0}) {
                const Lobe lobe{kind, parameter};
                const double angle = degrees * kPiDouble / 180;
                std::printf("%s %5.1f elevation %4.0f: none %.3f one %.3f two %.3f\n", lobe_kind_name(kind).data(),
                            parameter, degrees, mean_error(environment, none, lobe, angle, 12),
                            mean_error(environment, one, lobe, angle, 12),
                            mean_error(environment, two, lobe, angle, 12));
            }
    }
}

} // namespace

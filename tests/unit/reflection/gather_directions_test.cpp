#include "common/environment/analytic_sky.h"
#include "common/environment/lat_long.h"
#include "common/services/random.h"
#include "reflection/gather_directions.h"

#include <gtest/gtest.h>

#include <cmath>

namespace kokage::test {
namespace {

const Optics kLeaf{{0.3f, 0.4f, 0.1f}, {0.2f, 0.3f, 0.05f}};

/// Of one ray of the lobes and those to the sky that go with it, `times` times.
glm::dvec3 drawn_light(const GatherDirections& directions, const Image& sky, const glm::vec3& normal, int times,
                       double& variance) {
    Random random(7);
    const auto pair = [&] {
        const float first = random.uniform();
        return glm::vec2(first, random.uniform());
    };
    const GatherDirections::Lobes lobes(normal, kLeaf);
    glm::dvec3 sum(0.);
    double squares = 0;
    for (int k = 0; k < times; ++k) {
        glm::vec3 light(0.f);
        const auto add = [&](const GatherDirections::Drawn& drawn) {
            light += drawn.sky_weight * lat_long_radiance(sky, drawn.direction);
        };
        add(directions.of_lobes(lobes, pair()));
        for (int ray = 0; ray < GatherDirections::kSkyRays; ++ray) {
            const glm::vec2 numbers = pair();
            add(directions.to_sky(lobes, numbers, random.uniform()));
        }
        sum += glm::dvec3(light);
        squares += double(luminance(light)) * double(luminance(light));
    }
    const double mean = double(luminance(glm::vec3(sum))) / times;
    variance = squares / times - mean * mean;
    return sum / double(times);
}

/// Pixel by pixel.
glm::dvec3 summed_light(const Image& sky, const glm::vec3& normal) {
    glm::dvec3 sum(0.);
    constexpr int kRows = 360;
    for (int y = 0; y < kRows; ++y)
        for (int x = 0; x < 2 * kRows; ++x) {
            const glm::vec3 direction =
                direction_from_lat_long({(float(x) + 0.5f) / (2 * kRows), (float(y) + 0.5f) / kRows});
            const float cosine = glm::dot(normal, direction);
            const glm::vec3 scattered = (cosine > 0 ? kLeaf.reflectance : kLeaf.transmittance) * std::abs(cosine);
            sum += glm::dvec3(scattered * lat_long_radiance(sky, direction)) * pixel_solid_angle(y, 2 * kRows, kRows) /
                   kPiDouble;
        }
    return sum;
}

TEST(GatherDirections, MeetTheLightOfAnySkyInTheMean) {
    Environment spot;
    spot.remainder = Image(64, 32, 3);
    for (float& value : spot.remainder.pixels)
        value = 0.2f;
    for (int x = 20; x < 24; ++x)
        for (std::size_t c = 0; c < 3; ++c)
            spot.remainder.at(x, 8)[c] = 60;
    for (const bool above_ground : {false, true})
        for (const glm::vec3& normal : {glm::vec3(0, 1, 0), glm::normalize(glm::vec3(0.5f, -0.2f, 0.8f))}) {
            const GatherDirections directions(spot, above_ground);
            double variance = 0;
            const glm::dvec3 drawn = drawn_light(directions, spot.remainder, normal, 400000, variance);
            const glm::dvec3 truth = summed_light(spot.remainder, normal);
            for (std::size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(drawn[c] / truth[c], 1, 0.015);
        }
}

TEST(GatherDirections, GiveSurfacesTheWeightOfTheLobesAlone) {
    const Environment sky = constant_environment(glm::vec3(0.7f));
    for (const bool above_ground : {false, true}) {
        const GatherDirections directions(sky, above_ground);
        const glm::vec3 normal = glm::normalize(glm::vec3(0.5f, -0.2f, 0.8f));
        const GatherDirections::Lobes lobes(normal, kLeaf);
        Random random(3);
        glm::dvec3 sum(0.), towards(0.);
        constexpr int kTimes = 100000;
        for (int k = 0; k < kTimes; ++k) {
            const glm::vec2 numbers{(float(k) + random.uniform()) / kTimes, random.uniform()};
            const auto of_lobes = directions.of_lobes(lobes, numbers);
            sum += glm::dvec3(of_lobes.surface_weight) / double(kTimes);
            towards +=
                glm::dvec3(of_lobes.surface_weight) * double(glm::dot(of_lobes.direction, normal) > 0) / double(kTimes);
        }
        for (std::size_t c = 0; c < 3; ++c) { // bright all over: all that the leaf scatters, on each of its sides
            EXPECT_NEAR(sum[c], kLeaf.reflectance[c] + kLeaf.transmittance[c], 1e-5);
            EXPECT_NEAR(towards[c], kLeaf.reflectance[c], 1e-5);
        }
    }
}

TEST(GatherDirections, BlackSurfacesScatterNothing) {
    const GatherDirections directions(constant_environment(glm::vec3(1.f)), true);
    const glm::vec3 up(0, 1, 0);
    const Optics black;
    const GatherDirections::Lobes lobes(up, black);
    for (const auto& drawn : {directions.of_lobes(lobes, {0.3f, 0.6f}), directions.to_sky(lobes, {0.3f, 0.6f}, 0.2f)}) {
        EXPECT_EQ(drawn.surface_weight, glm::vec3(0.f));
        EXPECT_EQ(drawn.sky_weight, glm::vec3(0.f));
    }
    const Optics opaque{glm::vec3(0.5f), glm::vec3(0.f)}; // no place on the other side, to the last number
    const GatherDirections::Lobes before(up, opaque);
    for (const float number : {0.f, 0.5f, 0x1.fffffep-1f})
        EXPECT_GE(directions.of_lobes(before, {number, 0.4f}).direction.y, 0.f);
    const Optics lit_through{glm::vec3(0.f), glm::vec3(0.5f)}; // nor on this side, from the first number on
    const GatherDirections::Lobes behind(up, lit_through);
    for (const float number : {0.f, 0.5f, 0x1.fffffep-1f})
        EXPECT_LE(directions.of_lobes(behind, {number, 0.4f}).direction.y, 0.f);
}

TEST(GatherDirections, SeekBrightPartsWhereThereAreAny) {
    Environment spot = constant_environment(glm::vec3(0.2f));
    double even_variance = 0, variance = 0;
    drawn_light(GatherDirections(spot, false), spot.remainder, {0, 1, 0}, 10000, even_variance);
    EXPECT_LT(even_variance, 1e-9); // cosine lobes alone: each ray tells all
    spot.remainder = Image(64, 32, 3);
    for (std::size_t c = 0; c < 3; ++c)
        spot.remainder.at(20, 8)[c] = 600;
    const glm::dvec3 drawn = drawn_light(GatherDirections(spot, true), spot.remainder, {0, 1, 0}, 100000, variance);
    // Cosine lobes alone meet a pixel of a thousand: a variance of hundreds of times the mean's square.
    EXPECT_LT(variance, 6 * std::pow(double(luminance(glm::vec3(drawn))), 2));
}

} // namespace
} // namespace kokage::test

// The brute-force baker against its obvious twin, and what it makes of hard input.
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/lobe_over_cone.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

Environment noise_surroundings(int width, int height, std::uint64_t seed = 1) {
    Environment environment;
    environment.remainder = Image(width, height, 3);
    Random random(seed);
    for (float& value : environment.remainder.pixels)
        value = random.uniform();
    return environment;
}

glm::dvec3 drawn_direction(Random& random) {
    const double z = 2 * random.uniform_double() - 1, phi = 2 * kPiDouble * random.uniform_double();
    return {std::sqrt(1 - z * z) * std::cos(phi), z, std::sqrt(1 - z * z) * std::sin(phi)};
}

/// Random directions and the axes, one of each for every parameter.
TexelLayout layout_of(LobeKind kind, std::initializer_list<double> parameters, int directions) {
    TexelLayout layout;
    layout.kind = kind;
    Random random(7);
    for (double parameter : parameters) {
        for (int i = 0; i < directions; ++i)
            layout.directions.push_back(glm::vec3(drawn_direction(random)));
        for (const glm::vec3& axis :
             {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(-1, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 0, 1)})
            layout.directions.push_back(axis);
        layout.parameters.resize(layout.directions.size(), float(parameter));
    }
    return layout;
}

const std::initializer_list<double> kBruteForceExponents = {0, 0.3, 1, 9.7, 200, 5000, 1e5};
const std::initializer_list<double> kBruteForceRoughness = {1, 0.6, 0.2, 0.05, 0.001};

std::vector<glm::vec3> baked(const TexelLayout& layout, const Environment& environment) {
    std::vector<glm::vec3> filtered(layout.size());
    WorkReport report;
    brute_force_baker(layout, environment.remainder.width, environment.remainder.height)
        ->bake(environment, filtered, report);
    return filtered;
}

TEST(BruteForceBaker, AgreesWithItsTwin) {
    Environment environment = noise_surroundings(64, 32);
    DistantLight sun;
    sun.direction = glm::normalize(glm::vec3(1, 2, -1));
    sun.half_angle = 0.0047f;
    sun.irradiance = {3, 2, 1};
    DistantLight lamp = sun;
    lamp.direction = {0, 0, 1};
    lamp.half_angle = 0.4f;
    environment.distant_lights = {sun, lamp};
    for (const TexelLayout& layout :
         {layout_of(LobeKind::phong, kBruteForceExponents, 8), layout_of(LobeKind::ggx, kBruteForceRoughness, 8)}) {
        const auto filtered = baked(layout, environment);
        for (std::size_t i = 0; i < layout.size(); ++i) {
            const glm::dvec3 slow = filtered_by_brute_force(environment, {layout.kind, double(layout.parameters[i])},
                                                            glm::normalize(glm::dvec3(layout.directions[i])));
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(double(filtered[i][c]), slow[c], 1e-7 * slow[c])
                    << lobe_kind_name(layout.kind) << " " << layout.parameters[i] << " texel " << i;
        }
    }
}

TEST(BruteForceBaker, TwinIsTheFormula) { // eqs 8 and 9 with a power of the cosine, as printed
    const Environment environment = noise_surroundings(48, 24);
    Random random(3);
    for (double exponent : {0.3, 4.0, 60.0})
        for (int i = 0; i < 5; ++i) {
            const glm::dvec3 direction = drawn_direction(random);
            double weights = 0, sum = 0;
            for (int y = 0; y < 24; ++y)
                for (int x = 0; x < 48; ++x) {
                    const double cosine = glm::dot(pixel_direction(x, y, 48, 24), direction);
                    const double weight = cosine > 0 ? std::pow(cosine, exponent) * pixel_solid_angle(y, 48, 24) : 0.0;
                    weights += weight;
                    sum += weight * double(environment.remainder.at(x, y)[1]);
                }
            EXPECT_NEAR(filtered_by_brute_force(environment, {LobeKind::phong, exponent}, direction).y, sum / weights,
                        1e-12);
        }
}

TEST(BruteForceBaker, FurnaceStaysConstant) {
    Environment environment = noise_surroundings(128, 64);
    environment.remainder.pixels.assign(environment.remainder.pixels.size(), 0.7f);
    const double constant = double(0.7f);
    for (const TexelLayout& layout :
         {layout_of(LobeKind::phong, kBruteForceExponents, 4), layout_of(LobeKind::ggx, kBruteForceRoughness, 4)}) {
        for (const glm::vec3& value : baked(layout, environment))
            ASSERT_EQ(value, glm::vec3(0.7f));
        for (std::size_t i = 0; i < layout.size(); ++i) {
            const glm::dvec3 value = filtered_by_brute_force(environment, {layout.kind, double(layout.parameters[i])},
                                                             glm::dvec3(layout.directions[i]));
            ASSERT_NEAR(value.x, constant, 1e-12);
        }
    }
}

TEST(BruteForceBaker, HardImagesStayFinite) {
    for (auto [width, height] : {std::pair(1, 1), std::pair(2, 1), std::pair(3, 5), std::pair(33, 16)}) {
        Environment environment = noise_surroundings(width, height);
        environment.remainder.pixels[0] = 1e30f;
        environment.distant_lights.resize(1);
        environment.distant_lights[0].irradiance = glm::vec3(1e30f);
        environment.distant_lights[0].half_angle = 0.01f;
        for (const TexelLayout& layout :
             {layout_of(LobeKind::phong, kBruteForceExponents, 20), layout_of(LobeKind::ggx, kBruteForceRoughness, 20)})
            for (const glm::vec3& value : baked(layout, environment))
                for (std::size_t c = 0; c < 3; ++c) {
                    ASSERT_TRUE(std::isfinite(value[c])) << width << "x" << height;
                    ASSERT_GE(value[c], 0);
                }
    }
    const Environment environment = noise_surroundings(4, 2);
    WorkReport report;
    std::vector<glm::vec3> none;
    EXPECT_THROW(brute_force_baker({}, 8, 4)->bake(environment, none, report), InputError);
}

TEST(BruteForceBaker, SameBitsWithAnyThreads) {
    const Environment environment = noise_surroundings(64, 32);
    const TexelLayout layout = layout_of(LobeKind::phong, {1, 50, 5000}, 100);
    set_thread_count(1);
    const auto one = baked(layout, environment);
    set_thread_count(3);
    const auto three = baked(layout, environment);
    set_thread_count(0);
    EXPECT_EQ(one, three);
}

} // namespace

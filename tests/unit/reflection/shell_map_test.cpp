// Shells: their layout, lookups against an obvious twin, ends of the range, settings that make no sense.
#include "reflection/maps/shell_map.h"

#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/face_chart.h"
#include "tests/unit/common/scene_builders.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <limits>

namespace kokage {
namespace {

using test::random_direction;

TEST(ShellMap, ShellsCoverTheRangeAtTheirResolution) {
    for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic}) {
        const ShellMap map({.least_parameter = 1, .most_parameter = 1000, .filter = filter, .texels_a_width = 1.5});
        const auto& shells = map.shells();
        EXPECT_NEAR(shells.front().lobe.parameter, 1, 1e-12);
        EXPECT_NEAR(shells.back().lobe.parameter, 1000, 1e-9);
        std::size_t stored = 0, baked = 0;
        for (std::size_t i = 0; i < shells.size(); ++i) {
            EXPECT_EQ(shells[i].first, stored);
            EXPECT_EQ(shells[i].first_baked, baked);
            const int edge = shells[i].resolution + 2 * map.border(),
                      all = shells[i].resolution + 2 * map.baked_border();
            stored += std::size_t(6 * edge * edge);
            baked += std::size_t(6 * all * all);
            if (i > 0) {
                EXPECT_LE(shells[i - 1].width, 1.4143f * shells[i].width);
                EXPECT_GE(shells[i].resolution, shells[i - 1].resolution);
            }
            EXPECT_LE(kPiDouble / 2 / (shells[i].resolution - 1), double(shells[i].width) / 1.5 * 1.0001);
        }
        EXPECT_EQ(map.layout().size(), baked);
        EXPECT_EQ(map.bytes(), stored * 6);
        EXPECT_EQ(map.texels().size(), map.bytes());
    }
}

TEST(ShellMap, LayoutIsTheGridOfEachFaceAndItsBorder) {
    const ShellMap map({.least_parameter = 3, .most_parameter = 3, .filter = TexelFilter::cubic});
    const int n = map.shells()[0].resolution, b = map.baked_border();
    std::size_t texel = 0;
    for (int face = 0; face < 6; ++face)
        for (int y = -b; y < n + b; ++y)
            for (int x = -b; x < n + b; ++x, ++texel) {
                const glm::dvec3 d = face_direction(face, 2.0 * x / (n - 1) - 1, 2.0 * y / (n - 1) - 1);
                ASSERT_LT(glm::length(d - glm::dvec3(map.layout().directions[texel])), 1e-6);
                ASSERT_EQ(map.layout().parameters[texel], 3.f);
            }
}

TEST(ShellMap, LookupsOnTexelsAndShellsAreThere) {
    // The mean of a lobe over a linear function of direction is linear too: bands 0 and 1 with k_1 = (L+1)/(L+2).
    for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic}) {
        ShellMap map({.least_parameter = 2,
                      .most_parameter = 400,
                      .filter = filter,
                      .format = TexelFormat::float_rgb,
                      .texels_a_width = 4});
        const auto truth = [](const glm::vec3& d, double exponent) {
            return glm::vec3(1) + 0.5f * float((exponent + 1) / (exponent + 2)) * d;
        };
        std::vector<glm::vec3> texels(map.layout().size());
        for (std::size_t i = 0; i < texels.size(); ++i)
            texels[i] = truth(map.layout().directions[i], double(map.layout().parameters[i]));
        map.set_texels(texels);
        Random random(6);
        const float on_shell = filter == TexelFilter::cubic ? 2e-5f : 1e-3f;
        for (int i = 0; i < 3000; ++i) {
            const glm::vec3 d = random_direction(random);
            for (const ShellMap::Shell& shell : map.shells())
                ASSERT_LT(glm::length(map.lookup(d, shell.lobe.parameter) - truth(d, shell.lobe.parameter)), on_shell);
            const double between = std::exp(double(random.uniform(0.7f, 6)));
            ASSERT_LT(glm::length(map.lookup(d, between) - truth(d, between)), 2e-3f);
        }
        EXPECT_EQ(map.lookup(glm::vec3(0, 1, 0), 1), map.lookup(glm::vec3(0, 1, 0), 2)); // the nearest end
        EXPECT_EQ(map.lookup(glm::vec3(0, 1, 0), 1e9), map.lookup(glm::vec3(0, 1, 0), 400));
    }
}

TEST(ShellMap, OneLobeIsOneShell) {
    ShellMap map({.least_parameter = 50, .most_parameter = 50, .format = TexelFormat::float_rgb});
    ASSERT_EQ(map.shells().size(), 1u);
    map.set_texels(std::vector<glm::vec3>(map.layout().size(), glm::vec3(0.3f)));
    EXPECT_NEAR(map.lookup(glm::vec3(0, 1, 0), 7).r, 0.3f, 1e-7);
}

TEST(ShellMap, SettingsThatMakeNoSenseAreRefused) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(ShellMap({.least_parameter = 5, .most_parameter = 4}), InputError);
    EXPECT_THROW(ShellMap({.least_parameter = nan}), InputError);
    EXPECT_THROW(ShellMap({.most_parameter = nan}), InputError);
    EXPECT_THROW(ShellMap({.least_parameter = -1}), InputError);
    EXPECT_THROW(ShellMap({.kind = LobeKind::ggx, .least_parameter = 0.1, .most_parameter = 1.5}), InputError);
    EXPECT_THROW(ShellMap({.kind = LobeKind::ggx, .least_parameter = 0, .most_parameter = 1}), InputError);
    EXPECT_THROW(ShellMap({.shell_ratio = 1}), InputError);
    EXPECT_THROW(ShellMap({.texels_a_width = nan}), InputError);
    ShellMap map({.most_parameter = 2});
    EXPECT_THROW(map.set_texels(std::vector<glm::vec3>(3)), InputError);
}

/// The paper's kind of colour pattern: hue once round, saturation downwards.
Environment colour_rings(int width) {
    Environment environment;
    environment.remainder = Image(width, width / 2, 3);
    for (int y = 0; y < width / 2; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c) {
                const double hue = std::fmod(6.0 * x / width + 4.0 * c, 6.0), saturation = (y + 0.5) / (width / 2);
                environment.remainder.at(x, y)[c] =
                    float(0.5 + saturation * (std::clamp(std::abs(hue - 3) - 1, 0.0, 1.0) - 0.5));
            }
    return environment;
}

TEST(ShellMap, BetweenTexelsAndShellsItIsNearBruteForce) {
    const Environment environment = colour_rings(128);
    for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic}) {
        ShellMap map({.most_parameter = 300, .filter = filter});
        std::vector<glm::vec3> texels(map.layout().size());
        WorkReport report;
        brute_force_baker(map.layout(), 128, 64)->bake(environment, texels, report);
        map.set_texels(texels);
        Random random(10);
        double sum = 0, largest = 0;
        constexpr int count = 1500;
        for (int i = 0; i < count; ++i) {
            const glm::vec3 direction = random_direction(random);
            const double parameter = std::exp(random.uniform_double() * std::log(300.0));
            const glm::dvec3 truth =
                filtered_by_brute_force(environment, {LobeKind::phong, parameter}, glm::dvec3(direction));
            const glm::dvec3 d = 255.0 * glm::abs(glm::dvec3(map.lookup(direction, parameter)) - truth);
            sum += (d.r + d.g + d.b) / 3;
            largest = std::max({largest, d.r, d.g, d.b});
        }
        EXPECT_LT(sum / count, filter == TexelFilter::cubic ? 0.05 : 0.07);
        EXPECT_LT(largest, filter == TexelFilter::cubic ? 1 : 3);
        // No step across the edges of faces.
        float step = 0;
        for (int i = 0; i < 2000; ++i) {
            const float along = random.uniform(-1, 1), exponent = std::exp(random.uniform(0, 5.7f));
            const glm::vec3 one = glm::normalize(glm::vec3(1, 0.99999f, along));
            const glm::vec3 other = glm::normalize(glm::vec3(0.99999f, 1, along));
            const glm::vec3 d = glm::abs(map.lookup(one, exponent) - map.lookup(other, exponent));
            step = std::max({step, d.x, d.y, d.z});
        }
        EXPECT_LT(255 * step, 0.25f);
        RecordProperty(filter == TexelFilter::cubic ? "cubic" : "bilinear", std::to_string(sum / count) + " " +
                                                                                std::to_string(largest) + " step " +
                                                                                std::to_string(255 * step));
    }
}

void expect_many_as_one_by_one(const ShellSettings& settings) {
    ShellMap map(settings);
    Random random(4);
    std::vector<glm::vec3> texels(map.layout().size());
    for (glm::vec3& texel : texels)
        for (int c = 0; c < 3; ++c)
            texel[c] = random.uniform() < 0.1f ? 1e-6f * random.uniform() : random.uniform();
    map.set_texels(texels);
    std::vector<glm::vec3> directions(5003), filtered(directions.size());
    std::vector<float> parameters(directions.size());
    for (std::size_t i = 0; i < directions.size(); ++i) {
        directions[i] = random_direction(random);
        parameters[i] = settings.kind == LobeKind::phong ? std::exp(random.uniform(-1, 7)) : random.uniform();
    }
    for (std::size_t i = 0; i < 24; ++i) { // axes, edges and corners of faces, both ends of the range
        directions[i] = glm::normalize(glm::vec3(int(i % 3) - 1, int(i / 3 % 3) - 1,
                                                 i < 9    ? 1
                                                 : i < 18 ? -1
                                                          : 0) +
                                       glm::vec3(0, 0, i == 22 ? 1 : 0));
        parameters[i] = i % 2 == 0 ? 0.f : 1e6f;
    }
    map.lookup(directions, parameters, filtered);
    for (std::size_t i = 0; i < directions.size(); ++i)
        ASSERT_LT(glm::length(filtered[i] - map.lookup(directions[i], double(parameters[i]))), 4e-5f)
            << i << " " << parameters[i];
}

TEST(ShellMap, ManyLookupsAreTheSameAsOneByOneOnEveryInstructionSet) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().DeInit();
        SCOPED_TRACE(hwy::TargetName(target));
        for (const TexelFormat format : {TexelFormat::half_rgb, TexelFormat::float_rgb, TexelFormat::shared_exponent})
            for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic})
                expect_many_as_one_by_one({.most_parameter = 300, .filter = filter, .format = format});
        expect_many_as_one_by_one({.kind = LobeKind::ggx, .least_parameter = 0.2, .most_parameter = 1});
        expect_many_as_one_by_one({.least_parameter = 7, .most_parameter = 7});
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
}

TEST(ShellMap, FewLookupsFillNoVector) {
    ShellMap map({.most_parameter = 30});
    map.set_texels(std::vector<glm::vec3>(map.layout().size(), glm::vec3(0.25f, 0.5f, 1)));
    for (std::size_t count = 0; count < 20; ++count) {
        const std::vector<glm::vec3> directions(count, glm::vec3(0, 0, 1));
        std::vector<glm::vec3> filtered(count);
        map.lookup(directions, std::vector<float>(count, 3.f), filtered);
        for (const glm::vec3& value : filtered)
            EXPECT_LT(glm::length(value - glm::vec3(0.25f, 0.5f, 1)), 1e-5f);
    }
}

} // namespace
} // namespace kokage

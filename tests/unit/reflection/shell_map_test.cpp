// Shells: their layout, lookups against an obvious twin, ends of the range, settings that make no sense.
#include "reflection/maps/shell_map.h"

#include "common/services/error.h"
#include "common/services/random.h"
#include "reflection/maps/face_chart.h"
#include "tests/unit/common/scene_builders.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace kokage {
namespace {

using test::random_direction;

TEST(ShellMap, ShellsCoverTheRangeAtTheirResolution) {
    const ShellMap map({.least_parameter = 1, .most_parameter = 1000, .shell_ratio = 2, .texels_a_width = 1.5});
    const auto& shells = map.shells();
    EXPECT_NEAR(shells.front().lobe.parameter, 1, 1e-12);
    EXPECT_NEAR(shells.back().lobe.parameter, 1000, 1e-9);
    std::size_t first = 0;
    for (std::size_t i = 0; i < shells.size(); ++i) {
        EXPECT_EQ(shells[i].first, first);
        first += std::size_t(6 * shells[i].resolution * shells[i].resolution);
        if (i > 0) {
            EXPECT_LE(lobe_spread(shells[i - 1].lobe), 2.0001 * lobe_spread(shells[i].lobe));
            EXPECT_GE(shells[i].resolution, shells[i - 1].resolution);
        }
        const double spacing = kPiDouble / 2 / (shells[i].resolution - 1);
        EXPECT_LE(spacing, std::sqrt(lobe_spread(shells[i].lobe)) / 1.5 * 1.0001);
    }
    EXPECT_EQ(map.layout().size(), first);
    EXPECT_EQ(map.bytes(), first * 6);
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

TEST(ShellMap, ManyLookupsAreTheSameAsOneByOne) {
    ShellMap map({.most_parameter = 300});
    Random random(4);
    std::vector<glm::vec3> texels(map.layout().size());
    for (glm::vec3& texel : texels)
        for (int c = 0; c < 3; ++c)
            texel[c] = random.uniform();
    map.set_texels(texels);
    std::vector<glm::vec3> directions(10001), filtered(directions.size());
    std::vector<float> parameters(directions.size());
    for (std::size_t i = 0; i < directions.size(); ++i)
        directions[i] = random_direction(random), parameters[i] = std::exp(random.uniform(-1, 7));
    map.lookup(directions, parameters, filtered);
    for (std::size_t i = 0; i < directions.size(); ++i)
        ASSERT_LT(glm::length(filtered[i] - map.lookup(directions[i], double(parameters[i]))), 2e-5f);
}

} // namespace
} // namespace kokage

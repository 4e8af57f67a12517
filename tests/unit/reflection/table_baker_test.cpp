#include "common/directions/sphere_sets.h"
#include "common/environment/lat_long.h"
#include "common/services/error.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/table_baker.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace kokage {
namespace {

TexelLayout few_texels(LobeKind kind, std::vector<float> parameters) {
    TexelLayout layout;
    layout.kind = kind;
    for (float parameter : parameters)
        for (const glm::dvec3& d : fibonacci_sphere(30).directions) {
            layout.directions.push_back(glm::vec3(d));
            layout.parameters.push_back(parameter);
        }
    return layout;
}

Environment smooth_surroundings(int width, int height) {
    Environment environment;
    environment.remainder = Image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const glm::dvec3 d = pixel_direction(x, y, width, height);
            environment.remainder.at(x, y)[0] = float(0.5 + 0.5 * d.x * d.y);
            environment.remainder.at(x, y)[1] = float(0.5 + 0.4 * d.z);
            environment.remainder.at(x, y)[2] = float(0.6 * (1 + d.y) * (1 - d.x * d.z));
        }
    return environment;
}

double mean_difference_255(const TexelLayout& layout, const Environment& environment,
                           const TableBakerSettings& settings) {
    WorkReport report;
    std::vector<glm::vec3> filtered(layout.size()), truth(layout.size());
    table_baker(layout, settings, report)->bake(environment, filtered, report);
    brute_force_baker(layout, environment.remainder.width, environment.remainder.height)
        ->bake(environment, truth, report);
    double sum = 0;
    for (std::size_t t = 0; t < layout.size(); ++t)
        for (glm::length_t c = 0; c < 3; ++c)
            sum += std::abs(double(filtered[t][c]) - double(truth[t][c])) * 255 / 3 / double(layout.size());
    return sum;
}

TEST(TableBaker, IsNearBruteForceOnWhatIsSmooth) {
    const TexelLayout phong = few_texels(LobeKind::phong, {1, 20, 300, 5000});
    for (double threshold : {0.001, 0.01})
        EXPECT_LT(mean_difference_255(phong, smooth_surroundings(512, 256), {.table = {.threshold = threshold}}), 0.25)
            << threshold;
    EXPECT_LT(mean_difference_255(phong, smooth_surroundings(1000, 480), {}), 0.25)
        << "a size that halves to no pyramid";
    const TexelLayout ggx = few_texels(LobeKind::ggx, {0.2f, 0.5f, 1});
    EXPECT_LT(mean_difference_255(ggx, smooth_surroundings(512, 256), {}), 3) << "its tails are cut off";
}

TEST(TableBaker, SaysHowFarItIsOffOnCoarseImages) {
    const TexelLayout layout = few_texels(LobeKind::phong, {1, 20, 300, 5000});
    const auto warnings = [&](int width) {
        WorkReport report;
        std::vector<glm::vec3> filtered(layout.size());
        table_baker(layout, {}, report)->bake(smooth_surroundings(width, width / 2), filtered, report);
        return report.warnings;
    };
    EXPECT_TRUE(warnings(400).empty());
    for (const int width : {16, 64, 128}) {
        const std::vector<std::string> said = warnings(width);
        ASSERT_EQ(said.size(), 1u) << width;
        const std::size_t about = said[0].find("about ");
        ASSERT_NE(about, std::string::npos) << said[0];
        const double told = std::stod(said[0].substr(about + 6));
        const double found = mean_difference_255(layout, smooth_surroundings(width, width / 2), {});
        std::printf("%d columns: told %g, found %g\n", width, told, found);
        EXPECT_GT(told, 0.8 * found) << width;
        EXPECT_LT(told, 4 * found) << width;
    }
}

TEST(TableBaker, FiltersWhatIsLinearInDirectionAlmostExactlyWhateverIsCutOff) {
    Environment environment = smooth_surroundings(512, 256);
    for (int y = 0; y < 256; ++y)
        for (int x = 0; x < 512; ++x) {
            const glm::dvec3 d = pixel_direction(x, y, 512, 256);
            for (int c = 0; c < 3; ++c)
                environment.remainder.at(x, y)[c] = float(1 + d[glm::length_t(c)]);
        }
    const TexelLayout layout = few_texels(LobeKind::phong, {3, 20, 300, 5000});
    const auto error = [&](TableWeights weights) {
        return mean_difference_255(layout, environment, {.table = {.threshold = 0.1, .weights = weights}});
    };
    EXPECT_LT(error(TableWeights::matched), 0.06); // the pyramid's blur, which is not the same at all latitudes
    EXPECT_GT(error(TableWeights::renormalised), 0.9);
}

TEST(TableBaker, FiltersTheLightsThatWereAdded) {
    Environment environment = smooth_surroundings(64, 32);
    DistantLight sun;
    sun.direction = glm::normalize(glm::vec3(1, 2, 3));
    sun.half_angle = 0.02f;
    sun.irradiance = glm::vec3(3, 2, 1);
    environment.distant_lights.push_back(sun);
    EXPECT_LT(mean_difference_255(few_texels(LobeKind::phong, {1, 20}), environment, {}), 0.8);
}

Environment sun_of_one_pixel() {
    Environment environment = smooth_surroundings(512, 256);
    for (int c = 0; c < 3; ++c)
        environment.remainder.at(180, 78)[c] = 1e6f;
    return environment;
}

double largest_relative_difference(std::span<const glm::vec3> values, std::span<const glm::vec3> truth) {
    double largest = 0;
    for (std::size_t t = 0; t < truth.size(); ++t)
        for (glm::length_t c = 0; c < 3; ++c)
            largest = std::max(largest, std::abs(double(values[t][c]) - double(truth[t][c])) /
                                            std::max(double(truth[t][c]), 0.1));
    return largest;
}

TEST(TableBaker, SplitsLightsOffTheImage) {
    const Environment environment = sun_of_one_pixel();
    for (const TexelLayout& layout :
         {few_texels(LobeKind::phong, {1, 20, 300, 5000}), few_texels(LobeKind::ggx, {0.2f, 0.6f})}) {
        std::vector<glm::vec3> truth(layout.size()), filtered(layout.size());
        WorkReport report;
        brute_force_baker(layout, 512, 256)->bake(environment, truth, report);
        for (const TableWeights weights : {TableWeights::matched, TableWeights::renormalised}) {
            table_baker(layout, {.table = {.weights = weights}}, report)->bake(environment, filtered, report);
            EXPECT_LT(largest_relative_difference(filtered, truth), 0.03); // of what is smooth, of GGX's tails
        }
        EXPECT_TRUE(report.warnings.empty());
    }
}

TEST(TableBaker, ThePapersWeightsStayAsPublishedAndSayWhatTheyMiss) {
    const Environment environment = sun_of_one_pixel();
    const TexelLayout layout = few_texels(LobeKind::phong, {20, 300});
    const TableSettings paper{.weights = TableWeights::paper};
    std::vector<glm::vec3> published(layout.size()), filtered(layout.size());
    WeightTable(layout, paper).filter(light_on_domes(environment.remainder), published);
    WorkReport report;
    const auto baker = table_baker(layout, {.table = paper}, report);
    baker->bake(environment, filtered, report);
    EXPECT_EQ(filtered, published);
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_NE(report.warnings[0].find("lights"), std::string::npos);
    baker->bake(smooth_surroundings(512, 256), filtered, report);
    EXPECT_EQ(report.warnings.size(), 1u) << "no lights, no warning";
}

TEST(TableBaker, KeepsItsTableAndTakesNoOther) {
    const TemporaryFolder folder;
    const TexelLayout layout = few_texels(LobeKind::phong, {5, 100});
    const TableBakerSettings settings{.stored_table = folder / "kept.table"};
    const Environment environment = smooth_surroundings(128, 64);
    std::vector<glm::vec3> first(layout.size()), second(layout.size());
    WorkReport making, reading;
    table_baker(layout, settings, making)->bake(environment, first, making);
    ASSERT_TRUE(std::filesystem::exists(settings.stored_table));
    table_baker(layout, settings, reading)->bake(environment, second, reading);
    EXPECT_EQ(first, second);
    EXPECT_EQ(making.stages.at(0).name, "making the weight table");
    EXPECT_EQ(reading.stages.at(0).name, "reading the weight table");
    EXPECT_THROW(table_baker(few_texels(LobeKind::ggx, {0.5f, 0.7f}), settings, reading), InputError);
}

TEST(TableBaker, OnePixelFillsTheSphere) {
    Environment environment;
    environment.remainder = Image(1, 1, 3);
    environment.remainder.pixels = {0.25f, 1, 1e30f};
    const TexelLayout layout = few_texels(LobeKind::phong, {0, 1, 5000, 1e6f});
    std::vector<glm::vec3> filtered(layout.size());
    WorkReport report;
    table_baker(layout, {}, report)->bake(environment, filtered, report);
    for (const glm::vec3& value : filtered) {
        EXPECT_NEAR(value.x, 0.25f, 1e-6f);
        EXPECT_NEAR(value.z, 1e30f, 1e25f);
    }
}

} // namespace
} // namespace kokage

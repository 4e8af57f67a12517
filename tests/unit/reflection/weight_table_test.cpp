#include "common/directions/lobes.h"
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/maps/direction_bands.h"
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/weight_table.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

namespace kokage {
namespace {

glm::vec3 float_direction(Random& random) {
    const float z = random.uniform(-1, 1), angle = random.uniform(0, 2 * kPi), r = std::sqrt(1 - z * z);
    return {r * std::cos(angle), r * std::sin(angle), z};
}

/// Directions without symmetry, exponents from 0.3 to 5000.
TexelLayout scattered_layout(int texels) {
    Random random(7);
    TexelLayout layout;
    for (int t = 0; t < texels; ++t) {
        layout.directions.push_back(float_direction(random));
        layout.parameters.push_back(float(0.3 * std::pow(5000 / 0.3, double(t) / (texels - 1))));
    }
    return layout;
}

/// The paper's cube of size^3 voxels ([R] eqs 6, 7, 13), without guards.
TexelLayout cube_layout(int size) {
    const RoughnessScale scale = RoughnessScale::solved(size);
    TexelLayout layout;
    for (int z = 0; z < size; ++z)
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x) {
                const glm::vec3 t = (glm::vec3(x, y, z) * 2.f + 1.f) / float(size) - 1.f;
                if (glm::length(t) > 1)
                    continue;
                layout.directions.push_back(glm::normalize(t));
                layout.parameters.push_back(float(scale.exponent(double(glm::length(t)))));
            }
    return layout;
}

/// A smooth, colourful light that is not symmetric.
Image colourful_image() {
    Image image(512, 256, 3);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] =
                    0.5f + 0.4f * std::sin(0.02f * float(x) * float(c + 1)) * std::sin(0.05f * float(y));
    return image;
}

/// The obvious twin: eq 8 over every vertex of the dome that `rows` fell on, in double.
glm::dvec3 direct_sum(const DomeLight& light, int level, const Lobe& lobe, const glm::dvec3& axis,
                      const TableSettings& settings) {
    const GeodesicDome& dome = dome_of_level(level).dome;
    const bool paper = settings.weights == TableWeights::paper;
    const double kept = (paper ? 3 : 1) * settings.threshold * lobe_value(lobe, 0);
    glm::dvec3 sum(0);
    double mass = 0;
    for (std::size_t v = 0; v < dome.directions.size(); ++v) {
        const glm::dvec3 apart = dome.directions[v] - axis;
        const double value = lobe_value(lobe, glm::dot(apart, apart));
        const double weight = paper ? value : value * dome.weights[v];
        if (paper || value > kept)
            mass += weight;
        if (value > kept)
            sum += weight * glm::dvec3(light[std::size_t(level)][v]);
    }
    return sum / mass;
}

/// Which dome: the coarsest with vertices / (4 pi peak) >= vertices_a_lobe.
int expected_level(const Lobe& lobe, const TableSettings& settings) {
    int level = 0;
    for (int l = 1; l < kDomeLevels; ++l)
        if (double(dome_of_level(l).dome.directions.size()) / (4 * kPiDouble * lobe_value(lobe, 0)) >=
            settings.vertices_a_lobe)
            level = l;
    return level;
}

void expect_direct_sums(const TexelLayout& layout, const TableSettings& settings, std::size_t stride) {
    const DomeLight light = light_on_domes(colourful_image());
    std::vector<glm::vec3> filtered(layout.size());
    WeightTable(layout, settings).filter(light, filtered);
    for (std::size_t t = 0; t < layout.size(); t += stride) {
        const Lobe lobe{layout.kind, double(layout.parameters[t])};
        const glm::dvec3 expected = direct_sum(light, expected_level(lobe, settings), lobe,
                                               glm::normalize(glm::dvec3(layout.directions[t])), settings);
        for (glm::length_t c = 0; c < 3; ++c)
            ASSERT_NEAR(double(filtered[t][c]), expected[c], 2e-4) << "texel " << t << ", parameter " << lobe.parameter;
    }
}

TEST(WeightTable, IsTheSumOverTheDome) {
    for (TableWeights weights : {TableWeights::renormalised, TableWeights::paper})
        for (double threshold : {0.001, 0.1})
            expect_direct_sums(scattered_layout(60), {.threshold = threshold, .weights = weights}, 1);
}

TEST(WeightTable, IsTheSumOverTheDomeForGgxToo) {
    TexelLayout layout = scattered_layout(40);
    layout.kind = LobeKind::ggx;
    for (std::size_t t = 0; t < layout.size(); ++t)
        layout.parameters[t] = 0.15f + 0.85f * float(t) / 39;
    expect_direct_sums(layout, {.threshold = 0.01, .weights = TableWeights::renormalised}, 1);
}

TEST(WeightTable, SymmetricTexelsShareRowsAndStayTheSumOverTheDome) {
    const TexelLayout layout = cube_layout(20);
    const WeightTable table(layout, {.threshold = 0.005});
    EXPECT_LT(table.rows(), layout.size() / 15); // 24 but for those on planes of symmetry
    EXPECT_LT(table.bytes(), table.unshared_bytes() / 8);
    EXPECT_GT(table.weights(), 15 * table.entries());
    expect_direct_sums(layout, {.threshold = 0.005, .weights = TableWeights::renormalised}, 61);
}

TEST(WeightTable, MatchedAndRenormalisedKeepAConstantAndThePapersLosesThreeThresholds) {
    const TexelLayout layout = scattered_layout(300);
    DomeLight light;
    for (int level = 0; level < kDomeLevels; ++level)
        light[std::size_t(level)].assign(dome_of_level(level).dome.directions.size(), glm::vec3(1.f));
    std::vector<glm::vec3> filtered(layout.size());
    for (double threshold : {0.001, 0.01, 0.1}) {
        for (TableWeights weights : {TableWeights::matched, TableWeights::renormalised}) {
            WeightTable(layout, {.threshold = threshold, .weights = weights}).filter(light, filtered);
            for (const glm::vec3& value : filtered)
                ASSERT_NEAR(value.x, 1.f, 3e-6f);
        }
        WeightTable(layout, {.threshold = threshold, .weights = TableWeights::paper}).filter(light, filtered);
        double mean = 0, expected = 0;
        for (std::size_t t = 0; t < layout.size(); ++t) {
            mean += double(filtered[t].x) / double(layout.size());
            // The mass of cos^L above a share c of the peak is 1 - c^((L+1)/L).
            const double exponent = double(layout.parameters[t]);
            expected += (1 - std::pow(3 * threshold, (exponent + 1) / exponent)) / double(layout.size());
        }
        EXPECT_NEAR(mean, expected, 0.01) << threshold;
    }
}

TEST(WeightTable, LobesNarrowerThanTheFinestDomeInterpolateIt) {
    TexelLayout layout = scattered_layout(500);
    std::fill(layout.parameters.begin(), layout.parameters.end(), 1e7f);
    DomeLight light;
    for (int level = 0; level < kDomeLevels; ++level)
        for (const glm::dvec3& d : dome_of_level(level).dome.directions)
            light[std::size_t(level)].push_back(glm::vec3(d)); // linear, so that interpolation is exact to second order
    std::vector<glm::vec3> filtered(layout.size());
    WeightTable(layout, {}).filter(light, filtered);
    for (std::size_t t = 0; t < layout.size(); ++t)
        ASSERT_LT(glm::distance(filtered[t], layout.directions[t]), 1e-4f);
}

TEST(WeightTable, SameBitsWithAnyNumberOfThreads) {
    const TexelLayout layout = cube_layout(16);
    const DomeLight light = light_on_domes(colourful_image());
    std::vector<glm::vec3> one(layout.size()), many(layout.size());
    set_thread_count(1);
    WeightTable(layout, {}).filter(light, one);
    set_thread_count(0);
    WeightTable(layout, {}).filter(light, many);
    EXPECT_EQ(one, many);
}

TEST(WeightTable, IsRefusedWhereItTakesTooMuchMemoryOrItsSettingsCantBe) {
    const TexelLayout layout = scattered_layout(300);
    try {
        WeightTable(layout, {.most_bytes = 100'000});
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("MB are allowed"), std::string::npos) << error.what();
    }
    for (double threshold : {0.0, -1.0, 0.3, double(NAN)})
        EXPECT_THROW(WeightTable(layout, {.threshold = threshold}), InputError) << threshold;
}

std::string refusal(const std::filesystem::path& file, const TexelLayout& layout, const TableSettings& settings) {
    try {
        WeightTable::load(file, layout, settings);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(WeightTable, ComesBackFromAFileAndAnyOtherFileIsRefusedByName) {
    const TemporaryFolder folder;
    const TexelLayout layout = cube_layout(10);
    const WeightTable table(layout, {});
    const std::filesystem::path file = folder / "cube.table";
    table.save(file);
    const DomeLight light = light_on_domes(colourful_image());
    std::vector<glm::vec3> made(layout.size()), loaded(layout.size());
    table.filter(light, made);
    const WeightTable again = WeightTable::load(file, layout, {});
    again.filter(light, loaded);
    EXPECT_EQ(made, loaded);
    EXPECT_EQ(table.bytes(), again.bytes());
    EXPECT_EQ(table.unshared_bytes(), again.unshared_bytes());

    const std::string bytes = read_text(file);
    const auto expect_refusal = [&](std::string changed, const char* why) {
        const std::filesystem::path other = folder / "other.table";
        std::ofstream(other, std::ios::binary) << changed;
        const std::string message = refusal(other, layout, {});
        EXPECT_NE(message.find("other.table"), std::string::npos) << message;
        EXPECT_NE(message.find(why), std::string::npos) << message;
    };
    expect_refusal("", "no weight table");
    expect_refusal("PNG" + bytes, "no weight table");
    expect_refusal(bytes.substr(0, bytes.size() - 1), "truncated");
    expect_refusal(bytes.substr(0, 100), "truncated");
    expect_refusal(bytes + "x", "altered");
    std::string version = bytes;
    version[8] = 9;
    expect_refusal(version, "version 9");
    for (std::size_t place : {std::size_t(17), std::size_t(25), std::size_t(120), bytes.size() / 2, bytes.size() - 1}) {
        std::string altered = bytes;
        altered[place] = char(altered[place] ^ 4);
        const std::filesystem::path other = folder / "other.table";
        std::ofstream(other, std::ios::binary) << altered;
        EXPECT_NE(refusal(other, layout, {}), "") << place;
    }
    EXPECT_NE(refusal(file, cube_layout(12), {}).find("another size"), std::string::npos);
    EXPECT_NE(refusal(file, layout, {.threshold = 0.01}).find("threshold"), std::string::npos);
    EXPECT_NE(refusal(file, layout, {.weights = TableWeights::paper}), "");
    EXPECT_NE(refusal(folder / "none.table", layout, {}).find("none.table"), std::string::npos);
}

TEST(DomePyramid, SymmetriesTakeDomesToThemselves) {
    for (int level = 1; level < kDomeLevels; ++level) {
        const Dome& dome = dome_of_level(level);
        for (int symmetry = 0; symmetry < kDomeSymmetries; ++symmetry) {
            std::vector<std::uint16_t> vertices = dome.vertex_of[std::size_t(symmetry)];
            for (std::size_t v = 0; v < vertices.size(); ++v)
                ASSERT_LT(
                    glm::distance(apply_symmetry(symmetry, dome.dome.directions[v]), dome.dome.directions[vertices[v]]),
                    1e-9);
            std::sort(vertices.begin(), vertices.end());
            EXPECT_EQ(std::unique(vertices.begin(), vertices.end()), vertices.end());
        }
    }
}

TEST(DirectionBands, FindsAllDirectionsOfACone) {
    const DirectionSet set = fibonacci_sphere(3000);
    const DirectionBands bands(set.directions);
    Random random(3);
    std::vector<glm::dvec3> axes = {{0, 1, 0}, {0, -1, 0}, {-1, 0, 0}, {-1, 0, -1e-12}, {1, 0, 0}};
    for (int i = 0; i < 200; ++i)
        axes.push_back(glm::normalize(glm::dvec3(float_direction(random))));
    for (const glm::dvec3& axis : axes)
        for (double angle : {0.0, 0.05, 0.5, 1.5707963, 2.5, 3.15}) {
            std::vector<std::uint32_t> near;
            bands.near(axis, angle, near);
            std::sort(near.begin(), near.end());
            ASSERT_EQ(std::unique(near.begin(), near.end()), near.end());
            for (std::uint32_t i = 0; i < set.directions.size(); ++i) {
                if (glm::dot(set.directions[i], axis) >= std::cos(std::min(angle, kPiDouble))) {
                    ASSERT_TRUE(std::binary_search(near.begin(), near.end(), i)) << angle;
                }
            }
        }
}

} // namespace
} // namespace kokage

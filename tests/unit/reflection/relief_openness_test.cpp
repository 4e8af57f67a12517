// Ambient occlusion of relief against surfaces with a formula, against rays and against plain marching.
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "common/services/random.h"
#include "reflection/relief/bilinear_cell.h"
#include "reflection/relief/exact_tracer.h"
#include "reflection/relief/horizon_sweep.h"
#include "reflection/relief/relief_openness.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>

using namespace kokage;

namespace {

constexpr double kPi = std::numbers::pi;

HeightField openness_field(int width, int height, HeightWrap wrap, auto&& depth) {
    HeightField field{width, height, wrap, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            field.depths.push_back(float(depth((x + 0.5) / width, (y + 0.5) / height)));
    return field;
}

HeightField crossed_waves(int width, int height, HeightWrap wrap) {
    return openness_field(width, height, wrap, [](double u, double v) {
        return 0.5 + 0.3 * std::sin(2 * kPi * (2 * u + v)) * std::cos(2 * kPi * (u - 2 * v)) +
               0.2 * std::sin(6 * kPi * v);
    });
}

double cell_depth(const HeightField& field, double x, double y) {
    const double i = std::floor(x), j = std::floor(y);
    return bilinear_cell(field, (long long)(i), (long long)(j)).depth(x - i, y - j);
}

glm::dvec2 texel_m(const HeightField& field, const ReliefScale& scale) {
    return glm::dvec2(scale.tile_m) / glm::dvec2(field.width, field.height);
}

/// By rays drawn about the normal, on strata.
double openness_by_rays(const HeightField& field, const ReliefTracer& tracer, const OpennessSettings& settings,
                        double x, double y, bool texel) {
    const double i = std::floor(x), j = std::floor(y);
    const BilinearCell cell = bilinear_cell(field, (long long)(i), (long long)(j));
    glm::dvec2 slope(cell.du + (y - j) * cell.duv, cell.dv + (x - i) * cell.duv);
    if (texel)
        slope = 0.5 * glm::dvec2(cell_depth(field, x + 1, y) - cell_depth(field, x - 1, y),
                                 cell_depth(field, x, y + 1) - cell_depth(field, x, y - 1));
    glm::dvec3 normal(0, 0, 1);
    if (settings.normal == OpennessNormal::surface)
        normal = relief_normal(glm::vec2(slope * glm::dvec2(field.width, field.height)), settings.scale);
    const glm::dvec3 a = glm::normalize(glm::cross(normal, glm::dvec3(0.36, 0.8, -0.48))), b = glm::cross(normal, a);
    constexpr int kStrata = 40;
    Random random(std::uint64_t(x * 1000), std::uint64_t(y * 1000));
    std::vector<ReliefRay> rays;
    for (int k = 0; k < kStrata * kStrata; ++k) {
        const double u = (k % kStrata + random.uniform_double()) / kStrata,
                     turn = 2 * kPi * (k / kStrata + random.uniform_double()) / kStrata;
        const glm::dvec3 d = std::sqrt(u) * (std::cos(turn) * a + std::sin(turn) * b) + std::sqrt(1 - u) * normal;
        rays.push_back(relief_ray({(x + 0.5) / field.width, (y + 0.5) / field.height}, glm::vec3(d), settings.scale,
                                  float(cell.depth(x - i, y - j)) - kShadowLift));
    }
    std::vector<std::uint8_t> hidden(rays.size());
    tracer.occluded(rays, hidden);
    return double(std::count(hidden.begin(), hidden.end(), 0)) / double(rays.size());
}

struct OpennessErrors {
    double at_texels = 0, between = 0; ///< root mean squares
};

OpennessErrors errors_against_rays(const HeightField& field, const ReliefOpenness& openness,
                                   const OpennessSettings& settings, std::uint64_t seed) {
    constexpr int kPoints = 120;
    const auto tracer = make_exact_tracer(field);
    Random random(seed);
    OpennessErrors errors;
    for (int k = 0; k < kPoints; ++k) {
        const double column = random.below(std::uint32_t(field.width)), row = random.below(std::uint32_t(field.height)),
                     x = column + random.uniform(0.02f, 0.98f), y = row + random.uniform(0.02f, 0.98f);
        const auto error = [&](double at_x, double at_y, bool texel) {
            const double found = openness.lookup({(at_x + 0.5) / field.width, (at_y + 0.5) / field.height});
            return std::pow(found - openness_by_rays(field, *tracer, settings, at_x, at_y, texel), 2) / kPoints;
        };
        errors.at_texels += error(column, row, true);
        errors.between += error(x, y, false);
    }
    return {std::sqrt(errors.at_texels), std::sqrt(errors.between)};
}

TEST(ReliefOpenness, OfAPlaneIsOne) {
    for (const OpennessNormal normal : {OpennessNormal::plane, OpennessNormal::surface})
        for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 7), std::pair(6, 5)})
            for (const float depth : {0.f, 0.4f, 1.f}) {
                const HeightField field{width, height, HeightWrap::repeat,
                                        std::vector<float>(std::size_t(width * height), depth)};
                const ReliefOpenness openness = horizon_openness(field, {{}, normal, 32});
                for (const std::uint8_t texel : openness.texels)
                    ASSERT_EQ(texel, 255);
                EXPECT_EQ(openness.lookup({0.3f, -7.2f}), 1);
                DepthMapSettings maps;
                maps.size = maps.traced_size = 4;
                const ReliefOpenness by_maps =
                    depth_map_openness(field, trace_depth_maps(maps, *make_exact_tracer(field)), normal);
                for (const std::uint8_t texel : by_maps.texels)
                    ASSERT_EQ(texel, 255);
            }
    const HeightField deep = crossed_waves(8, 8, HeightWrap::repeat);
    EXPECT_EQ(horizon_openness(deep, {{{1, 1}, 0}, OpennessNormal::surface, 16}).texels[11], 255) << "no depth at all";
}

/// Slopes of inclination α face each other: at the bottom the horizon's tangent is tan α |cos φ|, and the mean of
/// 1 / (1 + tan² α cos² φ) over φ is cos α.
TEST(ReliefOpenness, OfAGrooveIsTheCosineOfItsSlope) {
    constexpr int kSize = 32;
    const HeightField field = openness_field(kSize, kSize, HeightWrap::repeat,
                                             [](double u, double) { return 1 - 2 * std::abs(u - 0.5 - 0.5 / kSize); });
    for (const float depth_m : {0.1f, 0.5f, 2.f}) {
        const ReliefOpenness openness = horizon_openness(field, {{{1, 1}, depth_m}, OpennessNormal::plane, 64});
        const double inclination = std::atan(2 * double(depth_m));
        EXPECT_NEAR(openness.texels[kSize / 2] / 255., std::cos(inclination), 0.006) << depth_m;
        EXPECT_GT(openness.texels[0], 250) << "the ridge, which sees the others' tops";
        // Just beside the bottom, about the slope's own normal, the sky is a wedge of π - 2α between the slopes:
        // (1 - cos of it) / 2.
        const ReliefOpenness by_surface = horizon_openness(field, {{{1, 1}, depth_m}, OpennessNormal::surface, 64});
        EXPECT_NEAR(by_surface.lookup({0.5f + 0.55f / kSize, 0.3f}), (1 - std::cos(kPi - 2 * inclination)) / 2, 0.015)
            << depth_m;
    }
}

/// In the bottom of a cone the horizon would be α all around, cos² α; of bilinear cells the last one is steeper off the
/// axes, tan α (|cos φ| + |sin φ|) where it begins.
TEST(ReliefOpenness, OfAPitIsThatOfItsSlopes) {
    const HeightField field = openness_field(65, 65, HeightWrap::repeat, [](double u, double v) {
        return 1 - std::min(1., std::hypot(u - 0.5, v - 0.5) / 0.4);
    });
    for (const float depth_m : {0.1f, 0.4f, 1.f}) {
        const ReliefOpenness openness = horizon_openness(field, {{{1, 1}, depth_m}, OpennessNormal::plane, 64});
        double expected = 0;
        for (int k = 0; k < 1000; ++k) {
            const double turn = 2 * kPi * k / 1000,
                         tangent = double(depth_m) / 0.4 * (std::abs(std::cos(turn)) + std::abs(std::sin(turn)));
            expected += 1e-3 / (1 + tangent * tangent);
        }
        EXPECT_NEAR(openness.texels[32 * 65 + 32] / 255., expected, 0.006) << depth_m;
        EXPECT_GT(openness.texels[0], 240);
    }
}

TEST(ReliefOpenness, IsWhatRaysFind) {
    struct Situation {
        HeightField field;
        ReliefScale scale;
        OpennessNormal normal;
    };
    const Situation cases[] = {
        {crossed_waves(64, 64, HeightWrap::repeat), {}, OpennessNormal::surface},
        {crossed_waves(64, 64, HeightWrap::repeat), {{1, 1}, 0.4f}, OpennessNormal::plane},
        {crossed_waves(48, 31, HeightWrap::repeat), {{2, 1}, 0.3f}, OpennessNormal::surface},
        {crossed_waves(40, 56, HeightWrap::clamp), {{1, 1}, 0.3f}, OpennessNormal::surface},
    };
    std::uint64_t seed = 31;
    for (const Situation& c : cases) {
        const OpennessSettings settings{c.scale, c.normal, 48};
        const OpennessErrors errors =
            errors_against_rays(c.field, horizon_openness(c.field, settings), settings, ++seed);
        EXPECT_LT(errors.at_texels, 0.007) << "seed " << seed; // of which the rays' own noise is half
        EXPECT_LT(errors.between, 0.015) << "seed " << seed;
    }
}

TEST(ReliefOpenness, FromDepthMapsIsNearThatOfRays) {
    const HeightField field = crossed_waves(64, 64, HeightWrap::repeat);
    const OpennessSettings settings{{{1, 1}, 0.3f}, OpennessNormal::surface, 48};
    DepthMapSettings maps;
    maps.size = maps.traced_size = 64;
    maps.scale = settings.scale;
    const ReliefOpenness openness =
        depth_map_openness(field, trace_depth_maps(maps, *make_exact_tracer(field)), settings.normal);
    EXPECT_LT(errors_against_rays(field, openness, settings, 41).at_texels, 0.03);
    maps.size = 16;
    EXPECT_THROW(depth_map_openness(field, bound_depth_maps(field, maps), settings.normal), InputError);
}

/// The sweep against the slow way: along each azimuth, point by point.
TEST(HorizonSweep, FindsTheHighestElevation) {
    for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp})
        for (const auto& [width, height] : {std::pair(13, 9), std::pair(1, 7)}) {
            const HeightField field = crossed_waves(width, height, wrap);
            const ReliefScale scale{{1.5f, 1}, 0.4f};
            const glm::dvec2 metres = texel_m(field, scale);
            double shares = 0;
            std::vector<float> tangents(field.depths.size());
            for (const HorizonDirection& direction : horizon_directions(field, scale, 12)) {
                shares += direction.share;
                HorizonSweep(field, scale).run(direction, tangents);
                const double length = glm::length(glm::dvec2(direction.p, direction.q) * metres);
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        double highest = 0;
                        const double depth = field.depth(x, y);
                        // On the borders of cells, as the sweep; the reach is longer than what is looked at here.
                        for (int k = 1; k * length < 3; ++k)
                            for (int part = 0; part < 2520; ++part) {
                                const double s = k - 1 + (part + 1) / 2520., at_x = x + s * direction.p,
                                             at_y = y + s * direction.q;
                                if (std::abs(at_x - std::round(at_x)) > 1e-9 &&
                                    std::abs(at_y - std::round(at_y)) > 1e-9)
                                    continue;
                                highest = std::max(highest, (depth - cell_depth(field, at_x, at_y)) *
                                                                double(scale.depth_m) / (s * length));
                            }
                        ASSERT_NEAR(tangents[std::size_t(y * width + x)], highest, 0.03 + 0.02 * highest)
                            << x << ", " << y << " towards " << direction.p << ", " << direction.q;
                    }
            }
            EXPECT_NEAR(shares, 1, 1e-9);
        }
}

TEST(ReliefOpenness, IsTheSameOnAnyNumberOfThreadsAndStops) {
    const HeightField field = crossed_waves(60, 45, HeightWrap::repeat);
    set_thread_count(1);
    const ReliefOpenness one = horizon_openness(field, {});
    set_thread_count(3);
    const ReliefOpenness three = horizon_openness(field, {});
    set_thread_count(0);
    EXPECT_EQ(one.texels, three.texels);
    EXPECT_EQ(one.corners, three.corners);
    EXPECT_EQ(one.bytes(), 5u * 60 * 45);
    struct Stop final : Progress {
        bool stop_requested() const override { return true; }
    } stop;
    EXPECT_THROW(horizon_openness(field, {}, stop), Stopped);
}

TEST(ReliefOpenness, ComesBackFromItsFileAndOthersAreRefused) {
    const HeightField field = crossed_waves(12, 9, HeightWrap::repeat);
    const OpennessSettings settings{{}, OpennessNormal::surface, 8};
    const ReliefOpenness openness = horizon_openness(field, settings);
    const TemporaryFolder folder;
    const std::filesystem::path path = folder / "bark.open";
    save_openness(openness, path, field, settings);
    const ReliefOpenness again = load_openness(path, field, settings);
    EXPECT_EQ(again.texels, openness.texels);
    EXPECT_EQ(again.corners, openness.corners);
    EXPECT_EQ(again.lookup({0.37f, 0.81f}), openness.lookup({0.37f, 0.81f}));
    OpennessSettings deeper = settings;
    deeper.scale.depth_m = 0.2f;
    EXPECT_THROW(load_openness(path, field, deeper), InputError);
    EXPECT_THROW(load_openness(path, crossed_waves(12, 9, HeightWrap::clamp), settings), InputError);
    const std::string bytes = read_text(path);
    constexpr std::uint64_t seed = 9;
    Random random(seed);
    for (int k = 0; k < 60; ++k) {
        std::string mutated = bytes;
        char& byte = mutated[random.below(std::uint32_t(bytes.size()))];
        byte = char(byte ^ 16);
        std::ofstream(path, std::ios::binary | std::ios::trunc)
            << (k == 0 ? bytes.substr(0, bytes.size() - 9) : mutated);
        EXPECT_THROW(load_openness(path, field, settings), InputError) << "seed " << seed << ", " << k;
    }
}

TEST(ReliefOpenness, RefusesSettingsThatMakeNoSense) {
    const HeightField field = crossed_waves(8, 8, HeightWrap::repeat);
    EXPECT_THROW(horizon_openness(field, {{}, OpennessNormal::plane, 3}), InputError);
    EXPECT_THROW(horizon_openness(field, {{}, OpennessNormal::plane, 10000}), InputError);
    EXPECT_THROW(horizon_openness(field, {{{0, 1}, 0.1f}, OpennessNormal::plane, 32}), InputError);
    EXPECT_THROW(horizon_openness(field, {{{1, 1}, -1}, OpennessNormal::plane, 32}), InputError);
    EXPECT_THROW(horizon_openness(field, {{{1, 1}, NAN}, OpennessNormal::plane, 32}), InputError);
}

TEST(ReliefOpenness, OfAVeryDeepMapIsFinite) {
    Random random(5);
    HeightField field{9, 14, HeightWrap::repeat, {}};
    for (int k = 0; k < 9 * 14; ++k)
        field.depths.push_back(random.uniform());
    for (const float depth_m : {1e-4f, 100.f})
        for (const OpennessNormal normal : {OpennessNormal::plane, OpennessNormal::surface}) {
            const ReliefOpenness openness = horizon_openness(field, {{{1, 1}, depth_m}, normal, 48});
            double mean = 0;
            for (const std::uint8_t texel : openness.texels)
                mean += texel / 255. / double(openness.texels.size());
            EXPECT_TRUE(depth_m > 1 ? mean < 0.4 : mean > 0.99) << mean;
        }
}

} // namespace

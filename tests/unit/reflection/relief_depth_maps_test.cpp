// Depth maps: what they hold against the truth, ray by ray and at random; files; threads.
#include "common/services/error.h"
#include "common/services/parallel.h"
#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/depth_maps.h"
#include "tests/support/random_relief.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <numbers>

using namespace kokage;

namespace {

HeightField waves(int width, int height, HeightWrap wrap = HeightWrap::repeat) {
    HeightField field{width, height, wrap, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            field.depths.push_back(0.5f + 0.5f * std::sin(12.566f * float(x) / float(width)) *
                                              std::cos(6.283f * float(y) / float(height) + 1.f));
    return field;
}

DepthMapSettings few_directions() {
    DepthMapSettings settings;
    settings.azimuths = 6;
    settings.zeniths = 4;
    settings.size = 8;
    settings.traced_size = 32;
    return settings;
}

bool same_depths(const DepthMaps& a, const DepthMaps& b) {
    return a.bytes() == b.bytes() && std::equal(a.depths(), a.depths() + a.bytes(), b.depths());
}

/// A Progress that asks to stop after some steps.
struct StopSoon final : Progress {
    bool stop_requested() const override { return true; }
};

TEST(ReliefDepthMaps, HoldTheLeastDepthOfTheFirstHitsOfEachBlock) {
    const HeightField field = waves(24, 17);
    const DepthMapSettings settings = few_directions();
    const DepthMaps maps = trace_depth_maps(settings, *make_cell_by_cell_tracer(field));
    const int block = settings.traced_size / settings.size;
    for (int map = 0; map < settings.maps(); ++map) {
        const double azimuth = 2 * std::numbers::pi * (map % 6) / 6, zenith = std::numbers::pi / 2 * (map / 6) / 4;
        const glm::vec2 slope =
            glm::vec2(std::tan(zenith) * 0.12 * std::cos(azimuth), std::tan(zenith) * 0.12 * std::sin(azimuth));
        for (int y = 0; y < settings.size; ++y)
            for (int x = 0; x < settings.size; ++x) {
                double least = 1;
                for (int j = y * block; j < (y + 1) * block; ++j)
                    for (int i = x * block; i < (x + 1) * block; ++i) {
                        const glm::vec2 o = (glm::vec2(i, j) + 0.5f) / float(settings.traced_size);
                        least = std::min(least, true_relief_hit(field, {{o, 0}, {slope, 1}}).depth);
                    }
                ASSERT_LE(maps.depth(map, x, y), least + 1e-6) << "map " << map << " at " << x << ", " << y;
                ASSERT_GT(maps.depth(map, x, y), least - 1. / 255 - 1e-6) << "map " << map << " at " << x << ", " << y;
            }
    }
}

TEST(ReliefDepthMaps, LowerBoundsHoldForEveryRayOfTheirCells) {
    constexpr std::uint64_t seed = 11;
    Random random(seed);
    int deep = 0, rays = 0;
    for (int map = 0; map < 30; ++map) {
        const HeightField field = random_height_field(random);
        DepthMapSettings settings;
        settings.azimuths = 1 + int(random.below(12));
        settings.zeniths = 1 + int(random.below(8));
        settings.size = 1 + int(random.below(20));
        settings.scale.depth_m = std::exp2(random.uniform(-6.f, 1.f));
        settings.scale.tile_m = {std::exp2(random.uniform(-1.f, 1.f)), 1};
        const DepthMaps bounds = bound_depth_maps(field, settings);
        for (int k = 0; k < 300; ++k) {
            const double azimuth = random.uniform_double() * 2 * std::numbers::pi,
                         zenith = random.uniform_double() * kLastBoundedZenith * std::numbers::pi / 180;
            const int ring = int(zenith / (std::numbers::pi / 2) * settings.zeniths),
                      sector =
                          int(std::lround(azimuth / (2 * std::numbers::pi) * settings.azimuths)) % settings.azimuths;
            const glm::dvec2 slope =
                relief_slope(settings.scale, std::tan(zenith) * glm::dvec2(std::cos(azimuth), std::sin(azimuth)));
            const glm::vec2 o(random.uniform(), random.uniform());
            const glm::ivec2 texel = glm::ivec2(o * float(settings.size));
            const float bound = bounds.depth(ring * settings.azimuths + sector, texel.x, texel.y);
            const TrueReliefHit hit = true_relief_hit(field, {{o, 0}, {slope, 1}});
            ASSERT_TRUE(hit.found());
            ASSERT_LE(double(bound), hit.t + 1e-6) << "seed " << seed << ", map " << map << ", ray " << k;
            deep += bound > 0.7 * hit.t;
            ++rays;
        }
    }
    EXPECT_GT(deep, rays / 5) << "bounds near the plane hold too, but are worth nothing";
}

TEST(ReliefDepthMaps, AreTheSameOnAnyNumberOfThreads) {
    const HeightField field = waves(24, 17);
    const auto source = make_cell_by_cell_tracer(field);
    set_thread_count(1);
    const DepthMaps hits = trace_depth_maps(few_directions(), *source),
                    bounds = bound_depth_maps(field, few_directions());
    set_thread_count(3);
    EXPECT_TRUE(same_depths(hits, trace_depth_maps(few_directions(), *source)));
    EXPECT_TRUE(same_depths(bounds, bound_depth_maps(field, few_directions())));
    set_thread_count(0);
    StopSoon stop;
    EXPECT_THROW(trace_depth_maps(few_directions(), *source, stop), Stopped);
    EXPECT_THROW(bound_depth_maps(field, few_directions(), stop), Stopped);
}

TEST(ReliefDepthMaps, OfConstantMapsAreTheirDepth) {
    for (const float depth : {0.f, 0.5f, 1.f}) {
        for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 7), std::pair(5, 3)}) {
            const HeightField field{width, height, HeightWrap::repeat,
                                    std::vector<float>(std::size_t(width * height), depth)};
            const DepthMaps hits = trace_depth_maps(few_directions(), *make_cell_by_cell_tracer(field)),
                            bounds = bound_depth_maps(field, few_directions());
            for (std::size_t k = 0; k < hits.bytes(); ++k) {
                ASSERT_EQ(int(hits.depths()[k]), int(depth * 255));
                ASSERT_EQ(int(bounds.depths()[k]), int(depth * 255));
            }
        }
    }
}

TEST(ReliefDepthMaps, ComeBackFromTheirFileAndOthersAreRefused) {
    const HeightField field = waves(24, 17);
    const DepthMapSettings settings = few_directions();
    const DepthMaps maps = bound_depth_maps(field, settings);
    const TemporaryFolder folder;
    const std::filesystem::path path = folder.path() / "bark.depths";
    maps.save(path, field);
    EXPECT_TRUE(same_depths(maps, DepthMaps::load(path, field, maps.kind(), settings)));

    const auto refusal = [&](const HeightField& of, DepthMapKind kind, const DepthMapSettings& with) {
        try {
            DepthMaps::load(path, of, kind, with);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("not refused");
    };
    HeightField other = field;
    other.depths[7] += 0.01f;
    EXPECT_NE(refusal(other, maps.kind(), settings).find("another height field"), std::string::npos);
    EXPECT_NE(refusal(field, DepthMapKind::first_hits, settings).find("another height field"), std::string::npos);
    DepthMapSettings wider = settings;
    wider.scale.tile_m.x = 2;
    EXPECT_NE(refusal(field, maps.kind(), wider).find("other settings"), std::string::npos);

    std::ifstream in(path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    const auto with = [&](const std::string& text) {
        std::ofstream(path, std::ios::binary | std::ios::trunc) << text;
        return refusal(field, maps.kind(), settings);
    };
    EXPECT_NE(with(bytes.substr(0, bytes.size() - 8)).find("truncated"), std::string::npos);
    constexpr std::uint64_t seed = 3;
    Random random(seed);
    for (int k = 0; k < 80; ++k) {
        std::string mutated = bytes;
        const std::uint32_t place = random.below(std::uint32_t(bytes.size()));
        mutated[place] = char(mutated[place] ^ char(1 << random.below(8)));
        const std::string why = with(mutated);
        ASSERT_NE(why.find("bark.depths"), std::string::npos) << "seed " << seed << ", byte " << place << ": " << why;
    }
}

TEST(ReliefDepthMaps, RefuseSettingsThatMakeNone) {
    const auto refused = [](auto&& change) {
        DepthMapSettings settings;
        change(settings);
        try {
            settings.check();
        } catch (const InputError&) {
            return true;
        }
        return false;
    };
    EXPECT_FALSE(refused([](DepthMapSettings&) {}));
    EXPECT_FALSE(refused([](DepthMapSettings& s) { s.size = 512; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.size = 0; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.size = 5000; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.azimuths = 0; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.zeniths = -1; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.traced_size = 100; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.traced_size = -64; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.scale.depth_m = 0; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.scale.tile_m.y = NAN; }));
    EXPECT_TRUE(refused([](DepthMapSettings& s) { s.azimuths = s.zeniths = 2048; }));
}

} // namespace

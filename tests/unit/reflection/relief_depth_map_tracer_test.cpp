// [D]'s search against a plain twin in double precision, and its conservative variant against the truth.
#include "common/services/error.h"
#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/depth_map_tracer.h"
#include "reflection/relief/exact_tracer.h"
#include "tests/support/random_relief.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

using namespace kokage;

namespace {

constexpr float kInfiniteNumber = std::numeric_limits<float>::infinity(),
                kNanNumber = std::numeric_limits<float>::quiet_NaN();

/// Cones on a flat ground, as [D] favours.
HeightField cones(int size, HeightWrap wrap = HeightWrap::repeat) {
    HeightField field{size, size, wrap, {}};
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const float u = (float(x) + 0.5f) / float(size), v = (float(y) + 0.5f) / float(size);
            const float cell_u = u * 3 - std::floor(u * 3) - 0.5f, cell_v = v * 3 - std::floor(v * 3) - 0.5f;
            field.depths.push_back(std::min(1.f, 4 * std::hypot(cell_u, cell_v)));
        }
    return field;
}

double depth_at(const HeightField& field, glm::dvec2 at) {
    const double x = at.x * field.width - 0.5, y = at.y * field.height - 0.5, i = std::floor(x), j = std::floor(y);
    const auto depth = [&](double column, double row) {
        return double(field.depth(int(column - field.width * std::floor(column / field.width)),
                                  int(row - field.height * std::floor(row / field.height))));
    };
    return std::lerp(std::lerp(depth(i, j), depth(i + 1, j), x - i),
                     std::lerp(depth(i, j + 1), depth(i + 1, j + 1), x - i), y - j);
}

/// Half as deep as the tile is wide, and maps that are made quickly.
DepthMapSettings half_deep() {
    DepthMapSettings settings;
    settings.size = 32;
    settings.traced_size = 64;
    settings.scale.depth_m = 0.5f;
    return settings;
}

struct PlainHit {
    double depth = 0;
    int reads = 0;
};

/// [D] 3, step by step, for a ray downwards from the plane.
PlainHit plain_search(const HeightField& field, const DepthMaps& maps, const DepthMapSearch& search, glm::dvec2 o,
                      glm::dvec2 slope) {
    const DepthMapSettings& settings = maps.settings();
    const glm::dvec2 metric = slope * glm::dvec2(settings.scale.tile_m) / double(settings.scale.depth_m);
    const double zenith = std::atan(glm::length(metric)), azimuth = std::atan2(metric.y, metric.x);
    const int ring = std::min(settings.zeniths - 1, int(zenith / (std::numbers::pi / 2) * settings.zeniths)),
              sector = (int(std::lround(azimuth / (2 * std::numbers::pi) * settings.azimuths)) + settings.azimuths) %
                       settings.azimuths;
    const int map = ring * settings.azimuths + sector;
    const glm::ivec2 texel = glm::ivec2(glm::floor(o * double(settings.size)));
    const double h = maps.depth(map, texel.x, texel.y);
    // Eq 1, as printed: |OP'| cos θ along the ray.
    const glm::dvec3 hit = h * glm::dvec3(sampling_slope(settings, map), 1),
                     view = glm::normalize(glm::dvec3(metric, 1));
    const double cos_angle = h > 0 ? glm::dot(glm::normalize(hit), view) : 1.;
    double z = std::min(1., glm::length(hit) * cos_angle * view.z);
    PlainHit found;
    found.reads = 1;
    const auto inside = [&](double depth) {
        ++found.reads;
        return depth >= depth_at(field, o + depth * slope);
    };
    const double stride = 1. / search.steps;
    double out = z, in = z;
    if (z > 0 && inside(z)) { // nothing is above the plane
        do {
            if (in <= 0)
                return {0, found.reads};
            out = in;
            in = std::max(0., in - stride);
        } while (inside(in));
        std::swap(in, out);
    } else {
        do {
            out = in;
            in = std::min(1., in + stride);
        } while (!inside(in));
    }
    for (int k = 0; k < search.bisections; ++k)
        (inside((out + in) / 2) ? in : out) = (out + in) / 2;
    found.depth = in;
    return found;
}

TEST(ReliefDepthMapTracer, SearchesAsThePaperSays) {
    const HeightField field = cones(48);
    DepthMapSettings settings;
    settings.size = settings.traced_size = 32;
    const DepthMaps maps = trace_depth_maps(settings, *make_exact_tracer(cones(16)));
    DepthMapSearch search;
    search.steps = 50;
    const auto tracer = make_depth_map_tracer(field, maps, search);
    constexpr std::uint64_t seed = 21;
    Random random(seed);
    std::vector<ReliefRay> rays(2003);
    for (ReliefRay& ray : rays) {
        const double zenith = random.uniform_double() * 1.5, azimuth = random.uniform_double() * 6.2831853;
        const glm::dvec2 slope =
            relief_slope(settings.scale, std::tan(zenith) * glm::dvec2(std::cos(azimuth), std::sin(azimuth)));
        ray = {{random.uniform(), random.uniform(), 0}, {slope, 1}};
    }
    std::vector<ReliefHit> hits(rays.size());
    tracer->trace(rays, hits);
    int different = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const PlainHit plain =
            plain_search(field, maps, search, glm::dvec2(rays[k].origin), glm::dvec2(rays[k].direction));
        // Single precision may take one side of a step or of a map's border for the other.
        different += !(std::abs(plain.depth - double(hits[k].t)) < 1e-3 && plain.reads == int(hits[k].reads));
    }
    EXPECT_LE(different, int(rays.size()) / 200) << "seed " << seed;
    // The paper's maps were made from another height field here, so hits lie before and behind them.
}

TEST(ReliefDepthMapTracer, HitsMostOfWhatIsThere) {
    const DepthMapSettings half = half_deep();
    for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp}) {
        const HeightField field = cones(64, wrap);
        const DepthMaps maps = trace_depth_maps(half, *make_exact_tracer(field));
        const auto tracer = make_depth_map_tracer(field, maps, {256, 10});
        constexpr std::uint64_t seed = 22;
        Random random(seed);
        std::vector<ReliefRay> rays(2000);
        for (ReliefRay& ray : rays) {
            const float z = random.uniform(0.17f, 1.35f), a = random.uniform(0.f, 6.2831853f), up = -random.uniform();
            ray = relief_ray({random.uniform(), random.uniform()},
                             {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), -std::cos(z)}, half.scale, up);
        }
        std::vector<ReliefHit> hits(rays.size());
        tracer->trace(rays, hits);
        int wrong = 0;
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const TrueReliefHit truth = true_relief_hit(field, rays[k]);
            ASSERT_TRUE(truth.found() && hits[k].found());
            const float length = glm::length(rays[k].direction * glm::vec3(1, 1, half.scale.depth_m));
            if (std::abs(hits[k].t - float(truth.t)) * length > 0.5f / 64) {
                ++wrong;
                continue;
            }
            EXPECT_NEAR(hits[k].depth, rays[k].origin.z + hits[k].t * rays[k].direction.z, 2e-3);
            const glm::vec2 at(rays[k].origin + hits[k].t * rays[k].direction);
            glm::vec2 apart = hits[k].coordinate - at;
            if (wrap == HeightWrap::repeat)
                apart -= glm::round(apart);
            EXPECT_LT(glm::length(apart), 1e-5);
        }
        EXPECT_LT(wrong, 120) << "seed " << seed;
    }
}

TEST(ReliefDepthMapTracer, TellsMostShadows) {
    const DepthMapSettings half = half_deep();
    const HeightField field = cones(64);
    const DepthMaps maps = trace_depth_maps(half, *make_exact_tracer(field));
    const auto tracer = make_depth_map_tracer(field, maps);
    Random random(23);
    std::vector<ReliefRay> rays;
    for (int k = 0; k < 2000; ++k) {
        const TrueReliefHit hit = true_relief_hit(field, {{random.uniform(), random.uniform(), 0}, {0.1, 0.1, 1}});
        const float z = random.uniform(0.1f, 1.4f), a = random.uniform(0.f, 6.2831853f);
        rays.push_back(relief_shadow_ray({0, glm::vec2(hit.coordinate), float(hit.depth), {}, 0},
                                         {std::sin(z) * std::cos(a), std::sin(z) * std::sin(a), std::cos(z)},
                                         half.scale));
    }
    std::vector<std::uint8_t> hidden(rays.size());
    std::vector<std::uint32_t> reads(rays.size());
    tracer->occluded(rays, hidden, reads);
    int wrong = 0, dark = 0;
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const bool truth = true_relief_hit(field, rays[k]).found();
        wrong += truth != (hidden[k] != 0);
        dark += truth;
        EXPECT_LT(reads[k], 200u);
    }
    EXPECT_GT(dark, 400);
    EXPECT_LT(wrong, 60);

    // Nothing on a plane shades anything.
    const HeightField flat{4, 4, HeightWrap::repeat, std::vector<float>(16, 0.5f)};
    const auto on_flat = make_depth_map_tracer(flat, trace_depth_maps(half, *make_exact_tracer(flat)));
    for (ReliefRay& ray : rays)
        ray.origin.z = 0.5f - kShadowLift;
    on_flat->occluded(rays, hidden);
    EXPECT_EQ(std::count(hidden.begin(), hidden.end(), 1), 0);
}

/// Any rays at all: no wrong hits but ties. Depth maps as well: a float or nothing, and never for ever.
TEST(ReliefDepthMapTracer, ConservativeIsRightForRandomRays) {
    constexpr std::uint64_t seed = 24;
    Random random(seed);
    int hits_found = 0, ties = 0;
    for (int map = 0; map < 60; ++map) {
        const HeightField field = random_height_field(random);
        DepthMapSettings settings;
        settings.azimuths = 1 + int(random.below(9));
        settings.zeniths = 1 + int(random.below(9));
        settings.size = 1 + int(random.below(16));
        settings.scale.depth_m = std::exp2(random.uniform(-8.f, 6.f));
        const auto tracer =
            make_conservative_tracer(field, bound_depth_maps(field, settings), make_cell_by_cell_tracer(field));
        std::vector<ReliefRay> rays(150);
        for (ReliefRay& ray : rays)
            ray = random_relief_ray(random, field);
        std::vector<ReliefHit> hits(rays.size());
        std::vector<std::uint8_t> hidden(rays.size());
        std::vector<std::uint32_t> reads(rays.size());
        tracer->trace(rays, hits);
        tracer->occluded(rays, hidden, reads);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", map " << map << ", ray " << k);
            const TrueReliefHit truth = true_relief_hit(field, rays[k]);
            ASSERT_EQ(hits[k].found(), hidden[k] != 0);
            const double per_t = std::max({double(glm::length(rays[k].direction)), 1e-30});
            const double difference = truth.found() && hits[k].found()   ? std::abs(truth.t - double(hits[k].t)) * per_t
                                      : truth.found() == hits[k].found() ? 0.
                                                                         : 1.;
            hits_found += truth.found();
            if (difference <= 1e-4 * (1 + double(std::abs(rays[k].origin.z)) + (truth.found() ? truth.t * per_t : 0)))
                continue;
            ++ties;
            const double nearer = std::min(truth.t, double(hits[k].t)), farther = std::max(truth.t, double(hits[k].t));
            const double before = greatest_depth_below(field, rays[k], 0, nearer + 1e-3 * (farther - nearer));
            ASSERT_NEAR(before, 0, 1e-4) << truth.t << " " << hits[k].t;
        }
    }
    EXPECT_GT(hits_found, 5000);
    EXPECT_LT(ties, 60);
}

TEST(ReliefDepthMapTracer, AnswersEveryRay) {
    constexpr std::uint64_t seed = 25;
    Random random(seed);
    for (int map = 0; map < 40; ++map) {
        const HeightField field = random_height_field(random);
        DepthMapSettings settings;
        settings.azimuths = 1 + int(random.below(9));
        settings.zeniths = 1 + int(random.below(5));
        settings.size = settings.traced_size = 1 + int(random.below(16));
        const auto tracer =
            make_depth_map_tracer(field, trace_depth_maps(settings, *make_cell_by_cell_tracer(field)), {16, 4});
        std::vector<ReliefRay> rays(200);
        for (ReliefRay& ray : rays)
            ray = random_relief_ray(random, field);
        rays[0].origin.x = kNanNumber;
        rays[1].direction.y = kInfiniteNumber;
        rays[2].t_most = kNanNumber;
        rays[3] = {{0.5, 0.5, 0}, {0, 0, 0}};
        rays[4] = {{1e6f, -1e6f, -1}, {1, 0, 1}};
        rays[5] = {{0, 0, -1}, {1, 0, -1}};
        std::vector<ReliefHit> hits(rays.size());
        std::vector<std::uint8_t> hidden(rays.size());
        tracer->trace(rays, hits);
        tracer->occluded(rays, hidden);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", map " << map << ", ray " << k);
            if (k < 3 || k == 5) {
                EXPECT_FALSE(hits[k].found());
            }
            if (!hits[k].found())
                continue;
            EXPECT_GE(hits[k].t, 0);
            EXPECT_LE(hits[k].t, rays[k].t_most * 1.0001f);
            EXPECT_TRUE(hits[k].depth >= 0 && hits[k].depth <= 1);
            EXPECT_TRUE(std::isfinite(hits[k].slope.x) && std::isfinite(hits[k].slope.y));
            if (field.wrap == HeightWrap::repeat) {
                EXPECT_TRUE(hits[k].coordinate.x >= 0 && hits[k].coordinate.x < 1);
            }
        }
        // Beside other rays or alone, the same.
        std::vector<ReliefHit> alone(1);
        for (std::size_t k = 6; k < 12; ++k) {
            tracer->trace(std::span(rays).subspan(k, 1), alone);
            EXPECT_EQ(alone[0].t, hits[k].t);
            EXPECT_EQ(alone[0].reads, hits[k].reads);
        }
    }
}

TEST(ReliefDepthMapTracer, WantsMapsOfItsOwnKind) {
    const HeightField field = cones(8);
    DepthMapSettings settings;
    settings.size = settings.traced_size = 4;
    const DepthMaps hits = trace_depth_maps(settings, *make_cell_by_cell_tracer(field)),
                    bounds = bound_depth_maps(field, settings);
    EXPECT_THROW(make_depth_map_tracer(field, bounds), InputError);
    EXPECT_THROW(make_conservative_tracer(field, hits, make_cell_by_cell_tracer(field)), InputError);
    EXPECT_THROW(make_depth_map_tracer(field, hits, {0, 6}), InputError);
    EXPECT_THROW(make_depth_map_tracer(field, hits, {64, 99}), InputError);
}

} // namespace

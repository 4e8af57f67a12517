// The truth of relief against dense marching and against surfaces with a formula.
#include "common/types.h"
#include "reflection/relief/cell_by_cell.h"
#include "tests/support/random_relief.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

constexpr float kInfiniteDepth = std::numeric_limits<float>::infinity(),
                kNanDepth = std::numeric_limits<float>::quiet_NaN();

HeightField field_of(int width, int height, HeightWrap wrap, auto&& depth) {
    HeightField field{width, height, wrap, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            field.depths.push_back(float(depth((x + 0.5) / width, (y + 0.5) / height)));
    return field;
}

/// Depth of the surface by the definition in height_field.h.
double sampled_depth(const HeightField& field, double u, double v) {
    const double x = u * field.width - 0.5, y = v * field.height - 0.5, i = std::floor(x), j = std::floor(y);
    const auto texel = [&](double at, int count) {
        return field.wrap == HeightWrap::clamp ? int(std::clamp(at, 0., count - 1.))
                                               : int(at - count * std::floor(at / count));
    };
    const auto depth = [&](double column, double row) {
        return double(field.depth(texel(column, field.width), texel(row, field.height)));
    };
    return std::lerp(std::lerp(depth(i, j), depth(i + 1, j), x - i),
                     std::lerp(depth(i, j + 1), depth(i + 1, j + 1), x - i), y - j);
}

/// How far the ray stands below the surface at t.
double below(const HeightField& field, const ReliefRay& ray, double t) {
    const glm::dvec3 p = glm::dvec3(ray.origin) + t * glm::dvec3(ray.direction);
    return p.z - sampled_depth(field, p.x, p.y);
}

/// Where a ray enters and leaves the part in which it can hit anything, by the definitions in relief_ray.h.
std::pair<double, double> span_of(const ReliefRay& ray) {
    const glm::dvec3 o(ray.origin), d(ray.direction);
    if (o.z < 0 && d.z <= 0)
        return {0, -1};
    const double first = o.z < 0 ? -o.z / d.z : 0;
    double last = double(ray.t_most);
    if (d.z > 0)
        last = std::min(last, std::max(first, (1 - o.z) / d.z));
    if (d.z < 0)
        last = std::min(last, -o.z / d.z);
    if (d.x != 0)
        last = std::min(last, first + double(kMostTilesCrossed) / std::abs(d.x));
    if (d.y != 0)
        last = std::min(last, first + double(kMostTilesCrossed) / std::abs(d.y));
    return {first, d == glm::dvec3(0.) ? first : last};
}

TEST(ReliefCellByCell, IsTheFirstPointThatIsNotAboveTheSurface) {
    constexpr std::uint64_t seed = 5;
    Random random(seed);
    int hits = 0, misses = 0;
    for (int map = 0; map < 300; ++map) {
        const HeightField field = random_height_field(random);
        for (int k = 0; k < 20; ++k) {
            const ReliefRay ray = random_relief_ray(random, field);
            SCOPED_TRACE(testing::Message() << "seed " << seed << ", map " << map << ", ray " << k);
            const TrueReliefHit hit = true_relief_hit(field, ray);
            auto [first, last] = span_of(ray);
            // Far away the sampled position itself is rounded; so is t_last.
            const double tiles = std::max({1., double(glm::length(glm::vec2(ray.origin))),
                                           last * double(glm::length(glm::vec2(ray.direction)))}),
                         close = 1e-12 * tiles * std::max(field.width, field.height) + 2e-9;
            if (hit.found()) {
                ++hits;
                ASSERT_GE(hit.t, first * (1 - 1e-12));
                ASSERT_LE(hit.t, last * (1 + 1e-8));
                const double at_hit = below(field, ray, hit.t);
                ASSERT_GE(at_hit, -close);
                if (hit.t > first) {
                    ASSERT_NEAR(at_hit, 0, close);
                }
                last = hit.t;
                ASSERT_GT(hit.reads, 0u);
            } else
                ++misses;
            for (int step = 0; step < 400 && first < last; ++step) {
                const double t = first + (last - first) * step / 400;
                ASSERT_LT(below(field, ray, t), close) << "t " << t << " of " << last;
            }
        }
    }
    EXPECT_GT(hits, 3000);
    EXPECT_GT(misses, 300);
}

TEST(ReliefCellByCell, SaysDepthCoordinateAndSlopeOfTheHit) {
    Random random(6);
    for (int k = 0; k < 2000; ++k) {
        const HeightField field = random_height_field(random);
        const ReliefRay ray = random_relief_ray(random, field);
        const TrueReliefHit hit = true_relief_hit(field, ray);
        if (!hit.found())
            continue;
        const glm::dvec2 c = hit.coordinate;
        ASSERT_NEAR(hit.depth, sampled_depth(field, c.x, c.y), 1e-9);
        if (field.wrap == HeightWrap::repeat) {
            ASSERT_TRUE(c.x >= 0 && c.x < 1 && c.y >= 0 && c.y < 1);
        }
        // By differences within the cell, which its borders do not cross.
        const glm::dvec2 size(field.width, field.height), from_border = glm::abs(glm::fract(c * size - 0.5) - 0.5);
        if (from_border.x > 0.49 || from_border.y > 0.49)
            continue;
        const double e = 1e-3 / std::max(size.x, size.y);
        const double du = (sampled_depth(field, c.x + e, c.y) - sampled_depth(field, c.x - e, c.y)) / (2 * e);
        const double dv = (sampled_depth(field, c.x, c.y + e) - sampled_depth(field, c.x, c.y - e)) / (2 * e);
        ASSERT_NEAR(hit.slope.x, du, 1e-6);
        ASSERT_NEAR(hit.slope.y, dv, 1e-6);
    }
}

TEST(ReliefCellByCell, HitsAPlaneWhereItStands) {
    // depth = 0.2 + 0.5 u + 0.1 v within the texels' centres; the border goes on level beyond them.
    const auto plane = [](double u, double v) { return 0.2 + 0.5 * u + 0.1 * v; };
    const HeightField field = field_of(32, 16, HeightWrap::clamp, plane);
    Random random(7);
    for (int k = 0; k < 1000; ++k) {
        const glm::vec2 from(random.uniform(0.3f, 0.7f), random.uniform(0.3f, 0.7f));
        const ReliefRay ray{{from, 0}, {random.uniform(-0.3f, 0.3f), random.uniform(-0.3f, 0.3f), 1}};
        const glm::dvec3 o(ray.origin), d(ray.direction);
        const double t = plane(o.x, o.y) / (d.z - 0.5 * d.x - 0.1 * d.y);
        const TrueReliefHit hit = true_relief_hit(field, ray);
        ASSERT_NEAR(hit.t, t, 1e-6); // depths are floats
        ASSERT_NEAR(hit.coordinate.x, o.x + t * d.x, 1e-6);
        ASSERT_NEAR(hit.coordinate.y, o.y + t * d.y, 1e-6);
        ASSERT_NEAR(hit.depth, t, 1e-6);
        ASSERT_NEAR(hit.slope.x, 0.5, 1e-5);
        ASSERT_NEAR(hit.slope.y, 0.1, 1e-5);
    }
}

TEST(ReliefCellByCell, HitsAConeWhereItStands) {
    const auto cone = [](double u, double v) { return std::min(1., std::hypot(u - 0.5, v - 0.5) / 0.4); };
    const HeightField field = field_of(512, 512, HeightWrap::repeat, cone);
    Random random(8);
    for (int k = 0; k < 1000; ++k) {
        // Towards the axis at a height below the tip, coming from outside the cone.
        const double turn = 2 * kPiDouble * random.uniform_double(), depth = 0.2 + 0.7 * random.uniform_double();
        const glm::dvec2 out(std::cos(turn), std::sin(turn));
        const ReliefRay ray{glm::vec3(0.5 + 0.49 * out, depth), glm::vec3(-out, 0)};
        const TrueReliefHit hit = true_relief_hit(field, ray);
        ASSERT_NEAR(hit.t, 0.49 - 0.4 * depth, 2e-4);
        ASSERT_NEAR(glm::dot(hit.slope, out), 2.5, 0.1);
    }
}

TEST(ReliefCellByCell, RepeatsOrClampsTheTile) {
    const auto step = [](double u, double) { return u < 0.5 ? 0.25 : 0.75; };
    const HeightField repeated = field_of(64, 4, HeightWrap::repeat, step),
                      clamped = field_of(64, 4, HeightWrap::clamp, step);
    for (const float tile : {-1000.f, -2.f, -1.f, 0.f, 1.f, 7.f, 1000.f})
        for (const float u : {0.25f, 0.75f}) {
            const ReliefRay down{{tile + u, 0.3f, 0}, {0, 0, 1}};
            EXPECT_DOUBLE_EQ(true_relief_hit(repeated, down).t, u < 0.5f ? 0.25 : 0.75);
            EXPECT_DOUBLE_EQ(true_relief_hit(clamped, down).t, tile < 0 || (tile == 0 && u < 0.5f) ? 0.25 : 0.75);
            EXPECT_NEAR(true_relief_hit(repeated, down).coordinate.x, double(u), 1e-12);
            EXPECT_NEAR(true_relief_hit(clamped, down).coordinate.x, double(tile) + double(u), 1e-9);
        }
    // Level at 0.5: the step's wall, from left and right; on the clamped one, none to the right of the tile.
    for (const float tile : {0.f, 300.f}) {
        EXPECT_NEAR(true_relief_hit(repeated, {{tile + 0.75f, 0, 0.5f}, {1, 0, 0}}).t, 0.25, 0.01);
        EXPECT_NEAR(true_relief_hit(repeated, {{tile + 0.75f, 0, 0.5f}, {-1, 0, 0}}).t, 0.25, 0.01);
        EXPECT_FALSE(true_relief_hit(clamped, {{tile + 0.75f, 0, 0.5f}, {1, 0, 0}}).found());
        EXPECT_NEAR(true_relief_hit(clamped, {{tile + 0.75f, 0, 0.5f}, {-1, 0, 0}}).t, double(tile) + 0.25, 0.01);
    }
}

TEST(ReliefCellByCell, TakesMapsOfOneTexelAndOneColumn) {
    const HeightField one{1, 1, HeightWrap::repeat, {0.25f}}, column{1, 7, HeightWrap::repeat, {0, 1, 0, 1, 0, 1, 1}};
    const HeightField row{7, 1, HeightWrap::clamp, {0, 1, 0, 1, 0, 1, 1}};
    EXPECT_DOUBLE_EQ(true_relief_hit(one, {{0.3f, 0.9f, 0}, {3, -5, 1}}).t, 0.25);
    EXPECT_DOUBLE_EQ(true_relief_hit(one, {{0.3f, 0.9f, -1}, {3, -5, 1}}).t, 1.25);
    EXPECT_NEAR(true_relief_hit(column, {{0.3f, 1.5f / 7, 0}, {40, 0, 1}}).t, 1, 2e-7);  // along a fissure
    EXPECT_NEAR(true_relief_hit(row, {{0.5f / 7, 0.3f, 0}, {0, 40, 1}}).t, 0, 2e-7);     // along a crest
    EXPECT_NEAR(true_relief_hit(column, {{0.3f, 1.f / 7, 0}, {40, 0, 1}}).t, 0.5, 2e-6); // along a texel's border
}

TEST(ReliefCellByCell, TakesOddRays) {
    const HeightField field{2, 2, HeightWrap::repeat, {0.5f, 1, 1, 1}};
    const auto t = [&](const ReliefRay& ray) { return true_relief_hit(field, ray).t; };
    const double never = std::numeric_limits<double>::infinity();
    // Parallel to the surface: above the peak, on the reference plane, at the peak's height, beside the peaks, below.
    EXPECT_EQ(t({{0, 0.25f, 0.4f}, {1, 0, 0}}), never);
    EXPECT_EQ(t({{0, 0.25f, 0}, {1, 0, 0}}), never);
    EXPECT_NEAR(t({{0, 0.25f, 0.5f}, {1, 0, 0}}), 0.25, 1e-12);
    EXPECT_NEAR(t({{0, 0.25f, 0.75f}, {-1, 0, 0}}), 0., 1e-12);
    EXPECT_EQ(t({{0, 0.75f, 0.75f}, {1, 0, 0}}), never);
    EXPECT_NEAR(t({{0, 0.75f, 1}, {1, 0, 0}}), 0., 1e-12);
    EXPECT_EQ(t({{0.3f, 0.75f, 1.5f}, {1, 0, 0}}), 0.);
    EXPECT_EQ(t({{0.3f, 0.75f, -0.5f}, {1, 0, 0}}), never);
    // Starting inside, going up and down; below everything.
    EXPECT_EQ(t({{0.25f, 0.25f, 0.6f}, {0, 0, -1}}), 0.);
    EXPECT_EQ(t({{0.25f, 0.25f, 0.6f}, {0.3f, 0, 1}}), 0.);
    EXPECT_EQ(t({{0.25f, 0.25f, 3}, {0, 0, -1}}), 0.);
    EXPECT_EQ(t({{0.25f, 0.25f, 3}, {0, 0, 1}}), 0.);
    // Starting above the surface: upwards and away, from above the plane as well; straight down on the peak.
    EXPECT_EQ(t({{0.25f, 0.25f, 0.4f}, {0.1f, 0, -1}}), never);
    EXPECT_EQ(t({{0.25f, 0.25f, -1}, {0, 0, -1}}), never);
    EXPECT_NEAR(t({{0.25f, 0.25f, -2}, {0, 0, 2}}), 1.25, 1e-12);
    // Coordinates of 1e6, where floats still tell eighths.
    EXPECT_NEAR(t({{1000000.25f, -999999.75f, 0}, {0, 0, 1}}), 0.5, 1e-12);
    EXPECT_NEAR(t({{1e6f, 0.25f, 0.5f}, {1, 0, 0}}), 0.25, 1e-12);
    EXPECT_NEAR(t({{1e30f, -1e38f, 0}, {0, 0, 1}}), 0.875, 1e-12);
    // Components of 0 and denormal ones.
    EXPECT_EQ(t({{0.25f, 0.25f, 0.4f}, {0, 0, 0}}), never);
    EXPECT_EQ(t({{0.25f, 0.25f, 0.6f}, {0, 0, 0}}), 0.);
    EXPECT_NEAR(t({{0.25f, 0.25f, 0}, {1e-42f, -1e-42f, 1}}), 0.5, 1e-12);
    EXPECT_EQ(t({{0.25f, 0.25f, 0.4f}, {1e-42f, 0, 0}}), never);
    // Nearly parallel: it has crossed too many tiles before it gets down; upwards from where it is.
    EXPECT_EQ(t({{0, 0.25f, 0}, {1, 0, 1e-42f}}), never);
    EXPECT_EQ(t({{0, 0.25f, 0.25f}, {1, 0, -1e-42f}}), never);
    EXPECT_EQ(t({{0.25f, 0.25f, 0}, {0, 0, 1e-42f}}), never); // t would be beyond what a float holds
    EXPECT_EQ(t({{0.25f, 0.25f, -1e30f}, {1e30f, 1e30f, 1e-42f}}), never);
    // Ends where t_most says, and not before.
    EXPECT_EQ(t({{0.25f, 0.25f, 0}, {0, 0, 1}, 0.49f}), never);
    EXPECT_NEAR(t({{0.25f, 0.25f, 0}, {0, 0, 1}, 0.5f}), 0.5, 1e-12);
    EXPECT_EQ(t({{0.25f, 0.25f, 0.4f}, {0, 0, 1}, -1.f}), never);
    // What is not finite hits nothing.
    for (const float bad : {kNanDepth, kInfiniteDepth, -kInfiniteDepth})
        for (int i = 0; i < 3; ++i) {
            ReliefRay from{{0.25f, 0.25f, 0}, {0, 0, 1}}, to = from;
            from.origin[i] = bad;
            to.direction[i] = bad;
            EXPECT_EQ(t(from), never);
            EXPECT_EQ(t(to), never);
        }
    EXPECT_EQ(t({{0.25f, 0.25f, 0}, {0, 0, 1}, kNanDepth}), never);
}

TEST(ReliefCellByCell, ClampedTilesGoOnForEver) {
    const HeightField field{2, 1, HeightWrap::clamp, {0.25f, 0.75f}};
    for (const float far : {1e6f, 1e20f, 3e38f}) {
        EXPECT_DOUBLE_EQ(true_relief_hit(field, {{far, 0, 0}, {-1, 0.1f, 1}}).t, 0.75);
        EXPECT_DOUBLE_EQ(true_relief_hit(field, {{-far, far, 0}, {1, -0.1f, 1}}).t, 0.25);
    }
}

TEST(ReliefCellByCell, RaysOfAFlatReliefGoStraightDownAndOfADeepOneGrazing) {
    const HeightField field = field_of(8, 8, HeightWrap::repeat, [](double u, double) { return u; });
    ReliefScale scale;
    const glm::vec3 view = glm::normalize(glm::vec3(0.6f, 0, -0.8f));
    scale.depth_m = 0;
    const TrueReliefHit flat = true_relief_hit(field, relief_ray({0.5f, 0.5f}, view, scale));
    EXPECT_NEAR(flat.coordinate.x, 0.5, 1e-12);
    EXPECT_EQ(relief_normal(glm::vec2(flat.slope), scale), glm::vec3(0, 0, 1));
    scale.depth_m = 100; // the ray crosses 75 tiles: it hits the crest, of depth 1/16, of one of the first tiles
    const TrueReliefHit deep = true_relief_hit(field, relief_ray({0.9f, 0.5f}, view, scale));
    ASSERT_TRUE(deep.found());
    EXPECT_NEAR(deep.coordinate.x, 1. / 16, 0.02);
    EXPECT_NEAR(deep.depth, 1. / 16, 1. / 75);
}

TEST(ReliefCellByCell, TellsHowNearARayComes) {
    const HeightField field{2, 2, HeightWrap::repeat, {0.5f, 1, 1, 1}};
    EXPECT_NEAR(greatest_depth_below(field, {{0, 0.25f, 0.4f}, {1, 0, 0}}, 0, 1), -0.1, 1e-7);
    EXPECT_NEAR(greatest_depth_below(field, {{0, 0.25f, 0.6f}, {1, 0, 0}}, 0, 1), 0.1, 1e-7);
    EXPECT_NEAR(greatest_depth_below(field, {{0, 0.25f, 0.4f}, {1, 0, 0}}, 0.5, 0.75), -0.35, 1e-6);
    // Diagonally over a cell the quadratic's own top counts: depth 1 - (1 - a)(1 - b)/2 on a = 1 - b.
    EXPECT_NEAR(greatest_depth_below(field, {{0.25f, 0.75f, 0.8f}, {1, -1, 0}}, 0, 0.5), -0.075, 1e-7);
}

TEST(ReliefCellByCell, TracerSaysTheSameAndOccludesWhatItHits) {
    Random random(9);
    for (int map = 0; map < 50; ++map) {
        const HeightField field = random_height_field(random);
        std::vector<ReliefRay> rays;
        for (int k = 0; k < 20; ++k)
            rays.push_back(random_relief_ray(random, field));
        const auto tracer = make_cell_by_cell_tracer(field);
        std::vector<ReliefHit> hits(rays.size());
        std::vector<std::uint8_t> hidden(rays.size());
        std::vector<std::uint32_t> reads(rays.size());
        tracer->trace(rays, hits);
        tracer->occluded(rays, hidden, reads);
        for (std::size_t k = 0; k < rays.size(); ++k) {
            const TrueReliefHit hit = true_relief_hit(field, rays[k]);
            ASSERT_EQ(hits[k].found(), hit.found());
            ASSERT_EQ(hidden[k] != 0, hit.found());
            ASSERT_EQ(reads[k], hit.reads);
            if (!hit.found())
                continue;
            ASSERT_EQ(hits[k].t, float(hit.t));
            ASSERT_EQ(hits[k].depth, float(hit.depth));
            if (field.wrap == HeightWrap::repeat) {
                ASSERT_TRUE(hits[k].coordinate.x >= 0 && hits[k].coordinate.x < 1);
            }
        }
    }
}

} // namespace

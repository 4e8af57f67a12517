// Cones against all texels and against dense samples of the surface; cone stepping against the truth.
#include "common/services/error.h"
#include "reflection/relief/bilinear_cell.h"
#include "reflection/relief/cell_by_cell.h"
#include "reflection/relief/cone_map.h"
#include "reflection/relief/cone_tracer.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/random_relief.h"
#include "tests/support/relief_rays.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>

using namespace kokage;

namespace {

/// Texels of a cell's corners that lie nearest, one axis: every corner and every copy of the tile.
int axis_distance(int cell, int texel, int count, HeightWrap wrap) {
    int least = 1 << 30;
    for (int tile = -2; tile <= 2; ++tile) {
        if (wrap == HeightWrap::clamp && tile != 0)
            continue;
        const int at = texel + tile * count;
        least = std::min(least, at < cell ? cell - at : at > cell + 1 ? at - cell - 1 : 0);
    }
    return least;
}

TEST(ReliefConeMap, IsTheWidestThatTheTexelsLeave) {
    Random random(21);
    for (int map = 0; map < 60; ++map) {
        const HeightField field = random_height_field(random, 12);
        const std::vector<CellCone> cones = make_cone_map(field);
        ASSERT_EQ(cones.size(), field.depths.size());
        for (int j = 0; j < field.height; ++j)
            for (int i = 0; i < field.width; ++i) {
                const BilinearCell cell = bilinear_cell(field, i, j);
                const float top =
                    float(std::min({cell.depth(0, 0), cell.depth(1, 0), cell.depth(0, 1), cell.depth(1, 1)}));
                double ratio = double(kEmptyRatio);
                for (int y = 0; y < field.height; ++y)
                    for (int x = 0; x < field.width; ++x) {
                        const double gap = double(top) - double(field.depth(x, y));
                        const int away = axis_distance(i, x, field.width, field.wrap) +
                                         axis_distance(j, y, field.height, field.wrap);
                        if (gap > 0)
                            ratio = std::min(ratio, away / gap);
                    }
                const CellCone& cone = cones[std::size_t(j * field.width + i)];
                ASSERT_NEAR(cone.top, top, 1e-6) << "map " << map << ", cell " << i << " " << j;
                ASSERT_LE(double(cone.ratio), ratio * (1 + 1e-6));
                ASSERT_GE(double(cone.ratio), ratio * (1 - 1e-5));
                ASSERT_GT(cone.ratio, 0);
            }
    }
}

// The whole bilinear surface stays out of the cones, over any point of their cells, across the tile's edges as well.
TEST(ReliefConeMap, HoldsNoSurface) {
    Random random(22);
    for (int map = 0; map < 200; ++map) {
        const HeightField field = random_height_field(random, 9);
        const std::vector<CellCone> cones = make_cone_map(field);
        for (int k = 0; k < 300; ++k) {
            const int i = int(random.below(std::uint32_t(field.width))),
                      j = int(random.below(std::uint32_t(field.height)));
            const CellCone& cone = cones[std::size_t(j * field.width + i)];
            const glm::dvec2 tip(i + random.uniform_double(), j + random.uniform_double());
            glm::dvec2 at(tip.x + 12 * random.uniform_double() - 6, tip.y + 12 * random.uniform_double() - 6);
            const long long x = (long long)(std::floor(at.x)), y = (long long)(std::floor(at.y));
            const double surface = bilinear_cell(field, x, y).depth(at.x - double(x), at.y - double(y));
            const double way = std::abs(at.x - tip.x) + std::abs(at.y - tip.y);
            ASSERT_GE(surface, double(cone.top) - way / double(cone.ratio) - 1e-6) << "map " << map;
        }
    }
}

void expect_true_hits(const HeightField& field, const std::vector<ReliefRay>& rays, std::size_t& ties) {
    const auto tracer = make_cone_tracer(field);
    std::vector<ReliefHit> hits(rays.size());
    std::vector<std::uint8_t> hidden(rays.size());
    std::vector<std::uint32_t> reads(rays.size());
    tracer->trace(rays, hits);
    tracer->occluded(rays, hidden, reads);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        const TrueReliefHit truth = true_relief_hit(field, rays[k]);
        ASSERT_EQ(hidden[k] != 0, hits[k].found());
        ASSERT_EQ(reads[k], hits[k].reads);
        const double first = std::min(truth.t, double(hits[k].t)), last = std::max(truth.t, double(hits[k].t));
        if (first == last ||
            std::abs(last - first) * double(glm::length(rays[k].direction)) * std::max(field.width, field.height) <
                0.05)
            continue;
        // Otherwise the first of both is a tie: the ray passes within rounding of the surface there.
        const double speed = double(glm::length(glm::vec2(rays[k].direction))) * std::max(field.width, field.height),
                     far = 1e-6 * std::max(1., first * speed) * std::max(field.width, field.height),
                     around = 1e-3 / (1 + speed);
        const double below = greatest_depth_below(field, rays[k], first - around, first + around);
        ASSERT_LT(std::abs(below), 1e-5 + far) << "ray " << k << ": true " << truth.t << " found " << hits[k].t
                                               << " field " << field.width << " x " << field.height;
        ++ties;
    }
}

void expect_true_hits_on_odd_fields() {
    constexpr std::uint64_t seed = 23;
    Random random(seed);
    std::size_t ties = 0;
    for (int map = 0; map < 80; ++map) {
        SCOPED_TRACE(testing::Message() << "seed " << seed << ", map " << map);
        const HeightField field = random_height_field(random);
        std::vector<ReliefRay> rays;
        for (int k = 0; k < 30; ++k)
            rays.push_back(random_relief_ray(random, field));
        for (const float bad :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 3e38f}) {
            rays.push_back({{bad, 0, 0}, {0, 0, 1}});
            rays.push_back({{0, 0, -bad}, {1, 0, bad}, bad});
        }
        ASSERT_NO_FATAL_FAILURE(expect_true_hits(field, rays, ties));
    }
    EXPECT_LT(ties, 100u);
}

TEST(ReliefCone, HitsAreTrueOnOddFieldsAndRaysWithEveryInstructionSet) {
    test::with_every_instruction_set(expect_true_hits_on_odd_fields);
}

TEST(ReliefCone, HitsAreTrueOnTheBenchmarksMapsWithFewReads) {
    for (const ReliefMap map : {ReliefMap::bark, ReliefMap::spikes, ReliefMap::low}) {
        const HeightField field = make_relief_map(map, 256, 256);
        const std::vector<ReliefRay> rays = view_rays(8000, 24);
        std::vector<ReliefHit> hits(rays.size());
        make_cone_tracer(field)->trace(rays, hits);
        const WrongHits wrong = wrong_hits(field, rays, hits);
        EXPECT_LE(wrong.count, 1u) << relief_map_name(map); // a tie
        EXPECT_LT(wrong.worst_right, 0.05);
        EXPECT_LT(wrong.reads_mean, 14) << relief_map_name(map); // measured 10.4, 10.8, 12.2
    }
}

TEST(ReliefCone, LoadsWhatItStoredForTheSameFieldAlone) {
    const TemporaryFolder folder;
    const HeightField field = make_relief_map(ReliefMap::bark, 40, 30), other = make_relief_map(ReliefMap::low, 40, 30);
    make_cone_tracer(field)->store(folder / "cones");
    const std::vector<ReliefRay> rays = view_rays(500, 26);
    std::vector<ReliefHit> made(rays.size()), loaded(rays.size());
    make_cone_tracer(field)->trace(rays, made);
    load_cone_tracer(field, folder / "cones")->trace(rays, loaded);
    for (std::size_t k = 0; k < rays.size(); ++k) {
        ASSERT_EQ(made[k].t, loaded[k].t);
        ASSERT_EQ(made[k].reads, loaded[k].reads);
    }
    EXPECT_THROW(load_cone_tracer(other, folder / "cones"), InputError);
    EXPECT_THROW(load_cone_tracer(field, folder / "none"), InputError);
}

TEST(ReliefCone, TakesTheTilesOfOneTexelAndConstantOnes) {
    for (const HeightWrap wrap : {HeightWrap::repeat, HeightWrap::clamp})
        for (const glm::ivec2 size : {glm::ivec2(1, 1), glm::ivec2(1, 7), glm::ivec2(5, 1)}) {
            const HeightField field{size.x, size.y, wrap, std::vector<float>(std::size_t(size.x * size.y), 0.5f)};
            const std::vector<ReliefRay> rays = view_rays(200, 25);
            std::vector<ReliefHit> hits(rays.size());
            make_cone_tracer(field)->trace(rays, hits);
            for (const ReliefHit& hit : hits) {
                EXPECT_NEAR(hit.depth, 0.5f, 1e-6f);
                EXPECT_LE(hit.reads, 4u);
            }
        }
}

} // namespace

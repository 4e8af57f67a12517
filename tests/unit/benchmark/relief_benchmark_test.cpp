#include "common/services/error.h"
#include "common/types.h"
#include "tests/benchmark/relief_benchmark.h"
#include "tests/benchmark/relief_judge.h"
#include "tests/benchmark/relief_maps.h"
#include "tests/benchmark/relief_tables.h"
#include "tests/benchmark/relief_views.h"
#include "tests/support/temporary_folder.h"

#include <cmath>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kokage {
namespace {

TEST(ReliefViews, PlaneIsSeenFromItsAngle) {
    for (const float degrees : {10.f, 55.f, 85.f}) {
        const ReliefView view = plane_view(degrees, 20, 3);
        ASSERT_EQ(view.rays.size(), 400u);
        for (const ReliefRay& ray : view.rays) {
            // Across, in tiles, over down, in tiles: the tangent of the angle.
            const float across = std::hypot(ray.direction.x, ray.direction.y),
                        down = ray.direction.z * kBenchReliefDepth;
            EXPECT_NEAR(across / down, std::tan(glm::radians(degrees)), 1e-3f * std::tan(glm::radians(degrees)));
            EXPECT_EQ(ray.origin.z, 0);
        }
    }
}

TEST(ReliefViews, SphereIsSeenFromTheFront) {
    const ReliefView view = sphere_view(64);
    ASSERT_EQ(view.rays.size(), view.pixels.size());
    EXPECT_NEAR(double(view.rays.size()), kPiDouble * 32 * 32, 100);
    for (const ReliefRay& ray : view.rays)
        EXPECT_GT(ray.direction.z, 0);
}

TEST(ReliefJudge, TellsWrongHitsFromTies) {
    // A post of half the depth on a flat ground; one ray over its top, one into its side.
    HeightField field{64, 64, HeightWrap::repeat, std::vector<float>(64 * 64, 1.f)};
    for (int y = 20; y < 40; ++y)
        for (int x = 20; x < 40; ++x)
            field.depths[std::size_t(y * 64 + x)] = 0.5f;
    const std::vector<ReliefRay> rays{{{0.1f, 0.47f, 0.f}, {0.4f, 0, 0.6f}}, {{0.1f, 0.47f, 0.f}, {0.02f, 0, 0.5f}}};
    const std::vector<TrueReliefHit> truth = true_hits(field, rays, silent_progress());
    std::vector<ReliefHit> hits(2);
    make_cell_by_cell_tracer(field)->trace(rays, hits);
    ReliefRecord record;
    judge(field, rays, hits, truth, kBenchReliefDepth, record);
    EXPECT_EQ(record.wrong, 0u);
    EXPECT_EQ(record.ties, 0u);

    hits[0].t *= 1.5f;
    hits[1] = {};
    judge(field, rays, hits, truth, kBenchReliefDepth, record);
    EXPECT_EQ(record.wrong, 2u);

    // A ray that skims the post's top without entering it: a hit there is a tie.
    const std::vector<ReliefRay> skimming{{{0.1f, 0.47f, 0.5f - 1e-7f}, {1.f, 0, 0}}};
    std::vector<ReliefHit> touch{{.t = 0.3f, .reads = 1}};
    judge(field, skimming, touch, true_hits(field, skimming, silent_progress()), kBenchReliefDepth, record);
    EXPECT_EQ(record.wrong.value() + record.ties.value(), 1u);
    EXPECT_EQ(record.ties, 1u);
}

TEST(ReliefTables, FiguresOfNothingAreNotMeasured) {
    const std::string figures = relief_figures({});
    EXPECT_NE(figures.find("not measured"), std::string::npos);
    EXPECT_EQ(figures.find("| met"), std::string::npos);
}

TEST(ReliefRecord, HasNullWhereThereIsNoFigure) {
    ReliefRecord record;
    record.map = "bark";
    record.wrong = 3;
    const nlohmann::json json = to_json(record);
    EXPECT_EQ(json["wrong"], 3);
    EXPECT_TRUE(json["reads_mean"].is_null());
    for (const char* key : {"map", "size", "view", "method", "rays", "wrong", "reads_mean", "reads_p99", "ns_per_ray",
                            "preprocess_cpu_seconds", "bytes"})
        EXPECT_TRUE(json.contains(key)) << key;
}

TEST(ReliefBenchmark, RefusesExperimentsThatItHasNot) {
    const TemporaryFolder folder;
    std::ostringstream out;
    EXPECT_THROW(
        run_relief_benchmark({.output_folder = folder.path(), .experiments = {"view"}}, silent_progress(), out),
        InputError);
}

} // namespace
} // namespace kokage

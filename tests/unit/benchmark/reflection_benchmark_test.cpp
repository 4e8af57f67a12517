#include "common/services/error.h"
#include "reflection/maps/brute_force_baker.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/benchmark/map_truth.h"
#include "tests/benchmark/reflection_benchmark.h"
#include "tests/benchmark/reflection_environments.h"
#include "tests/benchmark/reflection_tables.h"
#include "tests/support/temporary_folder.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kokage {
namespace {

TEST(ReflectionBenchmark, WritesRecordsAndAPageAndSaysWhatItSkipped) {
    const TemporaryFolder folder;
    std::ostringstream out;
    ASSERT_EQ(run_reflection_benchmark(
                  {.output_folder = folder.path(), .quick = true, .plots = false, .experiments = {"skips"}},
                  silent_progress(), out),
              0);
    const nlohmann::json records = nlohmann::json::parse(std::ifstream(folder / "reflection.json"));
    ASSERT_EQ(records.size(), 2u);
    EXPECT_EQ(records[0]["experiment"], "skips");
    EXPECT_EQ(records[0]["environment"], "pattern");
    EXPECT_LT(double(records[1]["bytes"]), 0.6 * double(records[0]["bytes"])) << "a part of the range takes less";
    EXPECT_LT(double(records[1]["texels"]), 0.6 * double(records[0]["texels"]));
    EXPECT_GT(records[1]["cpu_seconds"], 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "reflection.md"));
    EXPECT_NE(out.str().find("skipped: the photograph"), std::string::npos);
    EXPECT_NE(out.str().find("plots skipped"), std::string::npos);
}

TEST(ReflectionBenchmark, RefusesExperimentsThatItDoesNotHave) {
    const TemporaryFolder folder;
    std::ostringstream out;
    EXPECT_THROW(
        run_reflection_benchmark({.output_folder = folder.path(), .experiments = {"magic"}}, silent_progress(), out),
        InputError);
}

TEST(ReflectionBenchmark, FiguresTellTheWorstRecordAndWhatIsMissing) {
    ReflectionRecord one, other;
    one.experiment = other.experiment = "tables-2-3";
    one.method = other.method = "table";
    one.environment = other.environment = "pattern";
    one.mean_error_255 = 0.01;
    other.mean_error_255 = 0.07;
    const std::string short_figures = reflection_figures({one, other}), met = reflection_figures({one, one});
    EXPECT_NE(short_figures.find("| 0.070/255 | ≤ 0.050/255 | **short** |"), std::string::npos) << short_figures;
    EXPECT_NE(met.find("| 0.010/255 | ≤ 0.050/255 | met |"), std::string::npos) << met;
    EXPECT_NE(met.find("| – | ≥ 60.0 frames/s | not measured |"), std::string::npos) << met;
}

TEST(MapTruth, ErrorsAreThoseOfTheDefinition) {
    const std::vector<glm::vec3> truth = {{1, 1, 1}, {0, 0, 0}}, values = {{1.1f, 1, 1}, {0, 0, 0.002f}};
    ReflectionRecord record;
    judge(values, truth, record);
    EXPECT_NEAR(*record.mean_error_255, 255 * 0.102 / 6, 1e-4);
    EXPECT_NEAR(*record.max_error_255, 25.5, 1e-4);
    EXPECT_NEAR(*record.max_relative_error, 0.002 / (1e-3 * 0.5), 1e-5); // the mean of the truth is 0.5
    std::vector<glm::vec3> spoilt = values;
    spoilt[0].x = NAN;
    judge(spoilt, truth, record);
    EXPECT_TRUE(std::isnan(*record.max_error_255)) << "NaN must not pass for a small error";
    EXPECT_TRUE(std::isnan(*record.max_relative_error));
}

TEST(MapTruth, SamplesHoldTheTexelsTheyName) {
    const VoxelCube cube(LobeKind::phong, RoughnessScale::solved(64));
    for (const TexelSample& sample : {even_sample(cube.layout(), 500), sample_of_all_shells(cube.layout(), 400)}) {
        EXPECT_GT(sample.texels.size(), 200u);
        EXPECT_TRUE(std::is_sorted(sample.texels.begin(), sample.texels.end()));
        for (std::size_t i = 0; i < sample.texels.size(); ++i) {
            EXPECT_EQ(sample.layout.directions[i], cube.layout().directions[sample.texels[i]]);
            EXPECT_EQ(sample.layout.parameters[i], cube.layout().parameters[sample.texels[i]]);
        }
    }
    // Of all shells: rough ones count as much as smooth ones, which are a thousand times as many.
    const TexelSample shells = sample_of_all_shells(cube.layout(), 400);
    EXPECT_GT(std::count_if(shells.layout.parameters.begin(), shells.layout.parameters.end(),
                            [](float exponent) { return exponent < 100; }),
              30);
}

TEST(MapTruth, BruteForceOverPixelsAndOverTheDomeAgreeOnWhatIsSmooth) {
    const VoxelCube cube(LobeKind::phong, RoughnessScale::solved(16));
    const TexelSample sample = even_sample(cube.layout(), 40);
    const Image pattern = colour_pattern();
    const std::vector<glm::vec3> truth = true_texels(sample, unsplit(pattern, "pattern"));
    ReflectionRecord record;
    judge(true_texels_by_dome(sample, pattern), truth, record);
    EXPECT_LT(*record.mean_error_255, 0.2);
    EXPECT_GT(*record.mean_error_255, 0);
    const glm::dvec3 one =
        filtered_by_brute_force(unsplit(pattern, "pattern"), {LobeKind::phong, double(sample.layout.parameters[3])},
                                glm::normalize(glm::dvec3(sample.layout.directions[3])));
    EXPECT_LT(glm::distance(one, glm::dvec3(truth[3])), 1e-5);
}

} // namespace
} // namespace kokage

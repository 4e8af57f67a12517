#include "common/services/error.h"
#include "tests/benchmark/foliage_benchmark.h"

#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <unistd.h>

namespace kokage {
namespace {

class FoliageBenchmark : public testing::Test {
  protected:
    void SetUp() override {
        const std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
        options_.output_folder =
            std::filesystem::path(testing::TempDir()) / ("kokage-" + name + std::to_string(::getpid()));
        options_.references_folder = options_.output_folder / "none";
        options_.data_folder = options_.output_folder / "no data";
        options_.reference_paths = 512;
        options_.plots = false;
    }
    void TearDown() override { std::filesystem::remove_all(options_.output_folder); }

    nlohmann::json records() const {
        return nlohmann::json::parse(std::ifstream(options_.output_folder / "foliage.json"));
    }
    std::string report() const {
        std::ifstream file(options_.output_folder / "foliage.md");
        return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    }
    FoliageBenchmarkOptions options_;
    std::ostringstream out_;
};

TEST_F(FoliageBenchmark, measures_what_the_plan_says_and_says_what_it_skips) {
    const BenchSceneName tiny{BenchLight::sky_sun, 60, BenchMaterial::realistic};
    const std::vector<PlannedScene> plan{
        {tiny, {{Method::path_traced, "paths", 4}, {Method::path_traced, "paths", 64}}},
        {{BenchLight::lamp_lit, 60, BenchMaterial::realistic}, {{Method::path_traced, "paths", 4}}},
        {{BenchLight::furnace, 60, BenchMaterial::white}, {{Method::path_traced, "paths", 64}}}};
    ASSERT_EQ(run_foliage_benchmark(plan, options_, silent_progress(), out_), 0) << out_.str();

    const nlohmann::json json = records();
    ASSERT_EQ(json.size(), 3u);
    EXPECT_EQ(json[0]["scene"], "sky-sun");
    EXPECT_EQ(json[0]["method"], "path-traced");
    EXPECT_EQ(json[0]["effort"], 4);
    EXPECT_LT(json[1]["mre"], 0.6 * json[0]["mre"].get<double>()) << "16 times the paths";
    EXPECT_GT(json[1]["reference_noise"], 0.0);
    EXPECT_LT(json[1]["reference_noise"], json[1]["mre"]);
    EXPECT_GT(json[1]["cpu_seconds"], 0.0);
    EXPECT_GT(json[1]["relight_cpu_seconds"], 0.0);
    EXPECT_GT(json[1]["bytes_per_leaf"], 0.0);
    EXPECT_FALSE(json[1]["estimated_error"].is_null());
    EXPECT_EQ(json[2]["scene"], "furnace");
    EXPECT_EQ(json[2]["reference_noise"], 0.0) << "the furnace's truth is known";
    EXPECT_NE(report().find("skipped: 60-realistic-lamp-lit"), std::string::npos) << report();
    EXPECT_NE(out_.str().find("calibration loop"), std::string::npos);
}

TEST_F(FoliageBenchmark, one_method_that_fails_does_not_hide_the_others) {
    const std::vector<PlannedScene> plan{{{BenchLight::furnace, 60, BenchMaterial::white},
                                          {{Method::paper, "maps", -3}, {Method::path_traced, "paths", 4}}}};
    EXPECT_EQ(run_foliage_benchmark(plan, options_, silent_progress(), out_), 1);
    EXPECT_EQ(records().size(), 1u);
    EXPECT_NE(report().find("failed: paper on 60-white-furnace"), std::string::npos) << report();
}

TEST_F(FoliageBenchmark, a_run_that_is_stopped_leaves_the_finished_scenes) {
    struct StopLater : Progress {
        const std::filesystem::path file;
        explicit StopLater(std::filesystem::path f) : file(std::move(f)) {}
        bool stop_requested() const override {
            return std::filesystem::exists(file);
        } // once the first scene is written
    } progress(options_.output_folder / "foliage.json");
    const PlannedScene scene{{BenchLight::furnace, 60, BenchMaterial::white}, {{Method::path_traced, "paths", 4}}};
    EXPECT_THROW(run_foliage_benchmark({scene, scene}, options_, progress, out_), Stopped);
    EXPECT_EQ(records().size(), 1u);
    std::size_t files = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(options_.output_folder))
        ++files;
    EXPECT_EQ(files, 2u) << "foliage.json and foliage.md, nothing half-written";
}

TEST(BenchmarkPlan, names_every_scene_that_figures_are_judged_on) {
    std::set<std::string> full;
    for (const PlannedScene& planned : benchmark_plan(false)) {
        EXPECT_TRUE(full.insert(to_string(planned.name)).second) << to_string(planned.name) << " twice";
        EXPECT_FALSE(planned.efforts.empty());
    }
    for (const char* leaves : {"5000", "30000", "150000"})
        for (const char* material : {"realistic", "bright"})
            for (const char* light : {"sky-sun", "lamp-lit"})
                EXPECT_TRUE(full.count(std::string(leaves) + "-" + material + "-" + light))
                    << leaves << material << light;
    bool thousand_maps = false;
    for (const PlannedScene& planned : benchmark_plan(false))
        for (const PlannedEffort& effort : planned.efforts)
            if (effort.method == Method::paper) {
                thousand_maps = thousand_maps || effort.value == 1000;
                if (planned.name.leaves == 150000) {
                    EXPECT_LE(effort.value, 100);
                }
            }
    EXPECT_TRUE(thousand_maps);
    bool quick_30k = false;
    for (const PlannedScene& planned : benchmark_plan(true)) {
        EXPECT_TRUE(full.count(to_string(planned.name))) << "no stored reference: " << to_string(planned.name);
        quick_30k = quick_30k || to_string(planned.name) == "30000-realistic-sky-sun";
    }
    EXPECT_TRUE(quick_30k);
}

} // namespace
} // namespace kokage

#include "tests/benchmark/effort_plot.h"
#include "tests/benchmark/foliage_record.h"
#include "tests/benchmark/foliage_summary.h"
#include "tests/benchmark/foliage_tables.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

FoliageRecord record(Method method, const char* scene, std::uint32_t leaves, const char* material, double effort,
                     double cpu, double mre) {
    FoliageRecord r;
    r.method = method;
    r.scene = scene;
    r.leaves = leaves;
    r.material = material;
    r.effort = effort;
    r.effort_kind = "directions";
    r.cpu_seconds = cpu;
    r.accuracy.mre = mre;
    r.reference_noise = 0.005;
    return r;
}

/// error = 0.4 / sqrt(effort) for bundles at 0.01 CPU-s an effort; error = 0.5 / sqrt(effort) for path tracing at 0.2.
std::vector<FoliageRecord> power_law_records(const char* scene, const char* material) {
    std::vector<FoliageRecord> records;
    for (double effort : {8., 16., 32., 64., 128.})
        records.push_back(
            record(Method::bundles, scene, 30000, material, effort, 0.01 * effort, 0.4 / std::sqrt(effort)));
    for (double effort : {16., 64., 256.})
        records.push_back(
            record(Method::path_traced, scene, 30000, material, effort, 0.2 * effort, 0.5 / std::sqrt(effort)));
    return records;
}

const SummaryFigure* find(const std::vector<SummaryFigure>& figures, const std::string& beginning) {
    for (const SummaryFigure& figure : figures)
        if (figure.what.rfind(beginning, 0) == 0)
            return &figure;
    return nullptr;
}

TEST(FoliageRecord, json_has_every_field_that_readers_rely_on) {
    FoliageRecord r = record(Method::light_maps, "sky-sun", 30000, "realistic", 15, 1.5, 0.08);
    const nlohmann::json json = to_json(r);
    for (const char* field :
         {"scene", "leaves", "material", "method", "effort", "cpu_seconds", "wall_seconds", "relight_cpu_seconds",
          "bytes_per_leaf", "mre", "rmse_over_mean", "bias", "p95", "estimated_error", "reference_noise", "judged"})
        EXPECT_TRUE(json.contains(field)) << field;
    EXPECT_EQ(json["method"], "light-maps");
    EXPECT_EQ(json["leaves"], 30000);
    EXPECT_EQ(json["mre"], 0.08);
    EXPECT_TRUE(json["estimated_error"].is_null());
    EXPECT_TRUE(json["relight_cpu_seconds"].is_null());
    r.estimated_error = 0.07;
    EXPECT_EQ(to_json(r)["estimated_error"], 0.07);
    r.accuracy.mre = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(to_json(r)["mre"].is_null()) << "JSON has no NaN";
    EXPECT_EQ(to_json(r)["judged"], false) << "what is no number is not judged";
}

TEST(FoliageRecord, is_judged_from_five_times_the_noise_of_the_reference) {
    FoliageRecord r = record(Method::bundles, "sky-sun", 30000, "realistic", 32, 1, 0.0251);
    EXPECT_TRUE(r.judged());
    r.accuracy.mre = 0.0249;
    EXPECT_FALSE(r.judged());
    EXPECT_EQ(to_json(r)["judged"], false);
}

TEST(FoliageSummary, compares_methods_at_equal_error) {
    // Bundles reach e at 0.01 (0.4/e)^2, path tracing at 0.2 (0.5/e)^2: the ratio is 20 x 1.5625 = 31.25 at any error.
    const auto records = power_law_records("sky-sun", "realistic");
    const auto ratio = cpu_ratio(records, "sky-sun", 30000, "realistic", Method::path_traced, Method::bundles, 0.06);
    ASSERT_TRUE(ratio);
    EXPECT_NEAR(*ratio, 31.25, 1e-9);
    const SummaryFigure* figure = find(summarise(records), "CPU of path tracing over CPU of bundles");
    ASSERT_TRUE(figure);
    EXPECT_FALSE(figure->met()) << "31 is under 60";
    EXPECT_FALSE(cpu_ratio(records, "sky-sun", 30000, "bright", Method::path_traced, Method::bundles, 0.06));
    EXPECT_FALSE(cpu_ratio(records, "sky-sun", 30000, "realistic", Method::path_traced, Method::bundles, 0.001));
}

TEST(FoliageSummary, records_that_are_not_judged_take_no_part_in_comparisons) {
    auto records = power_law_records("sky-sun", "realistic");
    for (FoliageRecord& r : records)
        r.reference_noise = 0.02;
    EXPECT_FALSE(cpu_ratio(records, "sky-sun", 30000, "realistic", Method::path_traced, Method::bundles, 0.06));
}

TEST(FoliageSummary, scaling_compares_equal_efforts_per_leaf) {
    std::vector<FoliageRecord> records{record(Method::bundles, "sky-sun", 30000, "realistic", 32, 0.3, 0.06),
                                       record(Method::bundles, "sky-sun", 150000, "realistic", 64, 9.0, 0.06),
                                       record(Method::bundles, "sky-sun", 150000, "realistic", 32, 1.8, 0.06)};
    const SummaryFigure* figure = find(summarise(records), "time per leaf at 150k");
    ASSERT_TRUE(figure);
    EXPECT_NEAR(figure->value.value_or(0), 1.2, 1e-12);
    EXPECT_TRUE(figure->met());
}

TEST(FoliageSummary, honesty_is_the_worst_factor_either_way) {
    auto records = power_law_records("sky-sun", "realistic");
    for (FoliageRecord& r : records)
        r.estimated_error = 1.2 * r.accuracy.mre;
    records[1].estimated_error = records[1].accuracy.mre / 1.6;
    const auto figures = summarise(records);
    const SummaryFigure* bundles = find(figures, "estimated error of bundles");
    const SummaryFigure* paths = find(figures, "estimated error of path-traced");
    ASSERT_TRUE(bundles && paths);
    EXPECT_NEAR(bundles->value.value_or(0), 1.6, 1e-12);
    EXPECT_FALSE(bundles->met());
    EXPECT_NEAR(paths->value.value_or(0), 1.2, 1e-12);
    EXPECT_TRUE(paths->met());
}

TEST(FoliageSummary, bias_counts_on_either_side) {
    auto records = power_law_records("sky-sun", "realistic");
    for (FoliageRecord& r : records)
        r.accuracy.bias = -0.02;
    const SummaryFigure* figure = find(summarise(records), "bias");
    ASSERT_TRUE(figure);
    EXPECT_NEAR(figure->value.value_or(0), -2.0, 1e-12);
    EXPECT_FALSE(figure->met());
}

TEST(FoliageTables, tell_what_was_not_measured) {
    const std::string table = summary_table({{"something", std::nullopt, "x", 60.0, true},
                                             {"another", 61.0, "x", 60.0, true},
                                             {"a third", 59.0, "x", 60.0, true}});
    EXPECT_NE(table.find("| something | – | ≥ 60.0 | not measured |"), std::string::npos) << table;
    EXPECT_NE(table.find("| another | 61.0 x | ≥ 60.0 | met |"), std::string::npos) << table;
    EXPECT_NE(table.find("| a third | 59.0 x | ≥ 60.0 | **short** |"), std::string::npos) << table;
    const std::string rows = record_table(power_law_records("sky-sun", "realistic"));
    EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 2 + 8);
}

TEST(EffortPlot, script_holds_a_curve_for_each_method) {
    const std::string script = plot_script(power_law_records("sky-sun", "realistic"), "out.svg");
    EXPECT_NE(script.find("set output 'out.svg'"), std::string::npos);
    EXPECT_NE(script.find("$data0 with linespoints pointtype 1 title 'bundles (directions)'"), std::string::npos)
        << script;
    EXPECT_NE(script.find("$data1 with linespoints pointtype 2 title 'path-traced (directions)'"), std::string::npos)
        << script;
    EXPECT_NE(script.find("\n3.2 12.5\n"), std::string::npos) << script; // 16 paths: 3.2 CPU-s, 12.5 %
}

} // namespace
} // namespace kokage

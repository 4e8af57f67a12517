#include "tests/benchmark/reflection_benchmark.h"
#include "tests/support/temporary_folder.h"

#include <cstdlib>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kokage {
namespace {

nlohmann::json run(const std::filesystem::path& data, std::string& told) {
    const TemporaryFolder folder;
    std::ostringstream out;
    ReflectionBenchmarkOptions options;
    options.data_folder = data;
    options.output_folder = folder.path();
    options.quick = true;
    options.plots = false;
    options.experiments = {"cmgen"};
    EXPECT_EQ(run_reflection_benchmark(options, silent_progress(), out), 0);
    told = out.str();
    std::vector<std::string> names = folder.files();
    EXPECT_EQ(names, (std::vector<std::string>{"reflection.json", "reflection.md"})) << "maps are taken away again";
    return nlohmann::json::parse(std::ifstream(folder / "reflection.json"));
}

TEST(ReflectionCmgen, SaysWhatItNeeds) {
    std::string told;
    EXPECT_EQ(run("", told).size(), 0u);
    EXPECT_NE(told.find("skipped: cube maps beside cmgen's"), std::string::npos) << told;
}

TEST(ReflectionCmgen, BothAreJudgedInTheSameFrame) {
    const char* data = std::getenv("KOKAGE_DATA");
    if (!data || !*data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    std::string told;
    const nlohmann::json records = run(data, told);
    bool ours = false, theirs = false;
    for (const nlohmann::json& record : records) {
        if (!record["smoothness"].is_null())
            continue;
        const double error = record["mean_error_of_mean"];
        EXPECT_GT(record["cpu_seconds"], 0);
        if (record["method"] == "cmgen") {
            theirs = true;
            EXPECT_LT(error, 0.2); // noise; another frame gives more than 0.5
            EXPECT_GT(error, 0.01);
        } else {
            ours = true;
            EXPECT_LT(error, 0.005);
        }
    }
    EXPECT_TRUE(ours);
    EXPECT_EQ(theirs, told.find("skipped: cmgen is not installed") == std::string::npos);
}

} // namespace
} // namespace kokage

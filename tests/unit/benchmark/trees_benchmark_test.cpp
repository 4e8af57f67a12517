#include "tests/benchmark/peer_generators.h"
#include "tests/benchmark/tree_tables.h"
#include "tests/benchmark/trees_benchmark.h"
#include "tests/support/temporary_folder.h"

#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace kokage {
namespace {

TEST(TreesBenchmark, WritesARecordForEverySpeciesAndNumberOfLeaves) {
    const TemporaryFolder folder;
    std::ostringstream out;
    ASSERT_EQ(run_trees_benchmark({"oak", "birch"}, {50, 200},
                                  {.output_folder = folder.path(), .plots = false, .peers = false}, silent_progress(),
                                  out),
              0);
    const nlohmann::json records = nlohmann::json::parse(std::ifstream(folder / "trees.json"));
    ASSERT_EQ(records.size(), 4u);
    for (const nlohmann::json& record : records) {
        EXPECT_EQ(record["generator"], "kokage");
        EXPECT_GT(record["cpu_seconds"], 0);
        EXPECT_GT(record["bytes"], 0);
        EXPECT_GT(record["triangles"], record["leaves"]);
        EXPECT_LE(double(record["skeleton_and_leaves_cpu_seconds"]) + double(record["bark_cpu_seconds"]),
                  double(record["cpu_seconds"]) + 1e-6);
    }
    EXPECT_EQ(records[3]["species"], "birch");
    EXPECT_EQ(records[3]["leaves"], 200);
    EXPECT_TRUE(std::filesystem::exists(folder / "trees.md"));
    EXPECT_NE(out.str().find("plots skipped"), std::string::npos);
}

TEST(TreesBenchmark, ComparesTimesAtTheSameNumberOfLeaves) {
    std::vector<TreeRecord> records(3);
    records[0] = {"kokage", "oak", 1000, 1, 0.01, 1, {}, {}};
    records[1] = {"kokage", "oak", 100000, 1, 1.0, 1, 0.25, 0.5};
    records[2] = {"ez-tree", "Oak Medium", 10000, 1, 0.3, 1, {}, {}};
    EXPECT_NEAR(cpu_seconds_at(records, "kokage", "oak", 10000).value(), 0.1, 1e-9);
    EXPECT_FALSE(cpu_seconds_at(records, "kokage", "oak", 500));
    EXPECT_FALSE(cpu_seconds_at(records, "ez-tree", "Oak Medium", 10000)) << "one number of leaves is no curve";
    const std::string figures = growth_figures(records);
    EXPECT_NE(figures.find("| ez-tree's CPU over our oak's at as many leaves, median of 1 | 3.00 |"), std::string::npos)
        << figures;
    EXPECT_NE(figures.find("(slowest: oak) | 0.250 s | ≤ 0.100 s | **short** |"), std::string::npos) << figures;
}

TEST(TreesBenchmark, RunsEzTreeWhereItIsInstalled) {
    const PeerGenerator peer = peer_generators(3000, true).front();
    ASSERT_EQ(peer.name, "ez-tree");
    if (!peer.why_not.empty())
        GTEST_SKIP() << "skipped: " << peer.why_not;
    std::vector<TreeRecord> records;
    run_peer(peer, silent_progress(), [&](const TreeRecord& record) { records.push_back(record); });
    ASSERT_EQ(records.size(), 1u);
    EXPECT_EQ(records[0].leaves, 2660u) << "as its own 'Oak Medium' has them";
    EXPECT_EQ(records[0].triangles, 13806u);
    EXPECT_GT(records[0].cpu_seconds, 0);
}

TEST(TreesBenchmark, APeerThatFailsIsNamed) {
    const PeerGenerator peer{"broken", {"sh", "-c", "echo no record; exit 3"}, ""};
    try {
        run_peer(peer, silent_progress(), [](const TreeRecord&) {});
        FAIL();
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("'sh' failed"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace kokage

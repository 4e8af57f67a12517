// Khronos' glTF validator finds no error in what we write.
#include "tests/support/node.h"
#include "tests/support/program_run.h"
#include "tests/support/tree_files.h"
#include "trees/growth.h"
#include "trees/levels_of_detail.h"
#include "trees/read_tree.h"

namespace kokage {
namespace {

nlohmann::json validate_files(const std::string& modules, const std::vector<std::filesystem::path>& files) {
    std::vector<std::string> arguments{modules};
    arguments.insert(arguments.end(), files.begin(), files.end());
    return run_node("validate.js", arguments);
}

void expect_valid(const std::string& modules, const std::vector<std::filesystem::path>& files) {
    const nlohmann::json reports = validate_files(modules, files);
    ASSERT_EQ(reports.size(), files.size());
    for (std::size_t i = 0; i < files.size(); ++i) {
        const nlohmann::json& issues = reports[i]["issues"];
        EXPECT_EQ(issues["numErrors"], 0) << files[i] << ": " << issues["messages"].dump(1);
        EXPECT_EQ(issues["numWarnings"], 0) << files[i] << ": " << issues["messages"].dump(1);
        EXPECT_GT(reports[i]["info"]["totalTriangleCount"], 0) << files[i];
    }
}

TEST(Validator, FindsNoErrorInGrownTrees) {
    const std::string modules = node_modules_with("gltf-validator");
    if (modules.empty())
        GTEST_SKIP() << "skipped: node or the npm package gltf-validator is missing (npm ci in tests/validate)";
    TemporaryFolder folder;
    const Tree oak = small_oak();
    const ShadedAttributes light = random_light(oak);
    write_tree(folder / "plain.glb", oak);
    write_tree(folder / "shaded.glb", oak, &light);
    write_tree(folder / "split.glb", oak, &light, {.split_sides = true});
    expect_valid(modules, {folder / "plain.glb", folder / "shaded.glb", folder / "split.glb"});
}

TEST(Validator, FindsNoErrorInTreesOfAnySpeciesSeasonFormAndLevel) {
    const std::string modules = node_modules_with("gltf-validator");
    if (modules.empty())
        GTEST_SKIP() << "skipped: node or the npm package gltf-validator is missing (npm ci in tests/validate)";
    TemporaryFolder folder;
    std::vector<std::filesystem::path> files;
    for (const Species& species : all_species())
        for (const Season season : {Season::summer, Season::winter, Season::blossom}) {
            GrowthParameters p = species.parameters;
            p.leaves = 120;
            p.season = season;
            p.leaf_form = season == Season::blossom ? LeafForm::alpha : p.leaf_form;
            const Tree tree = grow(p);
            const ShadedAttributes light = random_light(tree);
            const LevelOfDetail level = level_of_detail(tree, 2);
            const ShadedAttributes coarse = transfer_light(tree, light, level);
            const std::string name = species.name + std::to_string(int(season));
            files.push_back(folder / (name + ".glb"));
            write_tree(files.back(), tree);
            files.push_back(folder / (name + "_level.glb"));
            write_tree(files.back(), level.tree, &coarse);
        }
    expect_valid(modules, files);
}

TEST(Validator, FindsTheErrorInABrokenFile) {
    const std::string modules = node_modules_with("gltf-validator");
    if (modules.empty())
        GTEST_SKIP() << "skipped: node or the npm package gltf-validator is missing (npm ci in tests/validate)";
    TemporaryFolder folder;
    std::ofstream(folder / "broken.gltf") << R"({"asset":{"version":"2.0"},"scene":3})";
    EXPECT_GT(validate_files(modules, {folder / "broken.gltf"})[0]["issues"]["numErrors"], 0);
}

TEST(Validator, FindsNoErrorInReexportedForeignTrees) {
    const std::string modules = node_modules_with("gltf-validator");
    if (modules.empty())
        GTEST_SKIP() << "skipped: node or the npm package gltf-validator is missing (npm ci in tests/validate)";
    const auto data = data_folder();
    if (!data)
        GTEST_SKIP() << "skipped: KOKAGE_DATA is not set";
    TemporaryFolder folder;
    std::vector<std::filesystem::path> files;
    for (const char* name :
         {"eztree_bush_1", "quaternius_common_tree_1", "quaternius_tex_pine_1", "kenney_tree_oak_fall"}) {
        const Tree tree = read_tree(*data / "trees" / (std::string(name) + ".glb"));
        const ShadedAttributes light = random_light(tree);
        files.push_back(folder / (std::string(name) + ".glb"));
        write_tree(files.back(), tree);
        files.push_back(folder / (std::string(name) + "_shaded.glb"));
        write_tree(files.back(), tree, &light, {.split_sides = true});
    }
    expect_valid(modules, files);
}

} // namespace
} // namespace kokage

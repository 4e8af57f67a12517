// Our KTX 2.0 on a sphere in three.js, a program that we did not write, against our own lookup of the same pixels.
#include "reflection/maps/cube_file.h"
#include "tests/support/cube_maps.h"
#include "tests/support/node.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace kokage {
namespace {

/// Texel noise on top of smooth colours, clamped to [0,1]: any shift, mirroring or blur shows.
PrefilteredCube lively_cube() {
    PrefilteredCube cube = smooth_cube({.size = 64, .parameters = {0, 0.2, 0.5, 1}});
    std::uint32_t random = 1;
    for (PrefilteredCube::Level& level : cube.levels)
        for (glm::vec3& texel : level.texels)
            for (int c = 0; c < 3; ++c) {
                random = random * 1664525u + 1013904223u;
                texel[c] = std::clamp(0.35f * texel[c] + 0.2f * float(random >> 8) / float(1 << 24), 0.f, 1.f);
            }
    return cube;
}

TEST(CubeThree, ASphereShowsWhatOurLookupGivesAtEveryLevel) {
    const std::string modules = node_modules_with("three");
    if (modules.empty() || !browser_is_there())
        GTEST_SKIP() << "skipped: the npm package three or the package chromium is missing (.ci/setup tests)";
    TemporaryFolder folder;
    const PrefilteredCube cube = lively_cube();
    const std::vector<TexelFormat> formats = {TexelFormat::half_rgb, TexelFormat::shared_exponent,
                                              TexelFormat::float_rgb};
    const std::vector<double> levels = {0, 1, 1.5, 2, 3};
    std::vector<std::string> arguments = {modules};
    nlohmann::json views = nlohmann::json::array();
    for (const TexelFormat format : formats) {
        const std::string name = std::string(texel_format_name(format)) + ".ktx2";
        arguments.push_back(folder / name);
        write_ktx2(folder / name, cube, format);
        for (const std::vector<double>& position : {std::vector<double>{2, 1.5, 2.2}, {-2.5, -1, -1.8}})
            views.push_back({{"name", name}, {"levels", levels}, {"position", position}, {"size", 96}});
    }
    std::ofstream(folder / "views.json") << views;
    const nlohmann::json all = run_node("cube_map.js", arguments, folder / "views.json");
    ASSERT_EQ(all.size(), views.size());
    for (std::size_t v = 0; v < all.size(); ++v) {
        const std::string name = views[v]["name"];
        const CubeFile file = read_ktx2(folder / name); // the same pixels: as the file holds them
        const nlohmann::json& directions = all[v]["directions"];
        ASSERT_GT(directions.size(), 2000u);
        ASSERT_EQ(all[v]["seen"].size(), levels.size());
        for (std::size_t i = 0; i < levels.size(); ++i) {
            double sum = 0, largest = 0;
            for (std::size_t p = 0; p < directions.size(); ++p) {
                const glm::dvec3 d(directions[p][0], directions[p][1], directions[p][2]);
                const glm::vec3 ours = cube_lookup(file.cube, d, levels[i]);
                for (int c = 0; c < 3; ++c) {
                    const double off = std::abs(double(ours[c]) - all[v]["seen"][i][p][std::size_t(c)].get<double>());
                    sum += off;
                    largest = std::max(largest, off);
                }
            }
            const double mean = sum / double(3 * directions.size());
            EXPECT_LE(255 * mean, 1) << name << ", level " << levels[i];
            EXPECT_LE(255 * largest, 4) << name << ", level " << levels[i];
            RecordProperty(name + "_view_" + std::to_string(v % 2) + "_level_" + std::to_string(levels[i]),
                           "mean " + std::to_string(255 * mean) + ", largest " + std::to_string(255 * largest));
        }
    }
}

} // namespace
} // namespace kokage

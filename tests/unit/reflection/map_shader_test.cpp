// Our GLSL on WebGL 2 looks maps up as our own code does: the same texels, the same directions and lobes.
#include "common/services/random.h"
#include "reflection/maps/horizon.h"
#include "reflection/maps/shell_atlas.h"
#include "reflection/maps/voxel_cube.h"
#include "tests/support/node.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/scene_builders.h"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

using nlohmann::json;

/// Smooth, so that rounded weights of a GPU's filter show as little, but different in every direction and shell.
std::vector<glm::vec3> smooth_texels(const TexelLayout& layout) {
    std::vector<glm::vec3> texels;
    for (std::size_t i = 0; i < layout.size(); ++i) {
        const glm::vec3 d = layout.directions[i];
        const float width = float(lobe_width({layout.kind, double(layout.parameters[i])}));
        texels.emplace_back(0.5f + 0.4f * std::sin(3 * d.x + d.y), 0.5f + 0.4f * d.y * d.z, 0.2f + 0.7f * width);
    }
    return texels;
}

struct Lookups {
    std::vector<glm::vec3> directions;
    std::vector<float> parameters;
};

Lookups random_lookups(float least, float most) {
    Random random(8);
    Lookups lookups;
    for (int i = 0; i < 1500; ++i) {
        lookups.directions.push_back(test::random_direction(random));
        lookups.parameters.push_back(random.uniform(least, most));
    }
    for (int i = 0; i < 26; ++i) { // middles, edges and corners of the faces
        const int k = i < 13 ? i : i + 1;
        lookups.directions.push_back(glm::normalize(glm::vec3(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
        lookups.parameters.push_back(i % 2 == 0 ? least : most);
    }
    return lookups;
}

json input_of(const Lookups& lookups) {
    json directions = json::array();
    for (const glm::vec3& d : lookups.directions)
        directions.push_back({d.x, d.y, d.z});
    return {{"directions", directions}, {"parameters", lookups.parameters}, {"uniforms", json::object()}};
}

/// Largest difference of the GPU's results from ours.
float largest_difference(const std::string& shader, const json& input, std::span<const glm::vec3> ours) {
    TemporaryFolder folder;
    std::ofstream(folder / "input.json") << input;
    const std::string path = std::string(KOKAGE_TESTS_FOLDER) + "/../reflection/maps/" + shader;
    const json seen = run_node("map_shader.js", {path}, folder / "input.json");
    EXPECT_EQ(seen.size(), ours.size());
    float largest = seen.size() == ours.size() ? 0.f : 1e9f;
    for (std::size_t i = 0; i < std::min(ours.size(), seen.size()); ++i)
        for (int c = 0; c < 3; ++c)
            largest = std::max(largest, std::abs(float(seen[i][std::size_t(c)]) - ours[i][c]));
    return largest;
}

TEST(MapShader, ShellsAreLookedUpAsOnTheCpu) {
    if (!browser_is_there())
        GTEST_SKIP() << "skipped: the package chromium is missing (.ci/setup tests)";
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx})
        for (const TexelFilter filter : {TexelFilter::bilinear, TexelFilter::cubic}) {
            const bool ggx = kind == LobeKind::ggx;
            ShellMap map({.kind = kind,
                          .least_parameter = ggx ? 0.4 : 1.0,
                          .most_parameter = ggx ? 1.0 : 40.0,
                          .filter = filter});
            map.set_texels(smooth_texels(map.layout()));
            const ShellAtlas atlas = shell_atlas(map.shells(), map.border());
            const Lookups lookups = ggx ? random_lookups(0.35f, 1) : random_lookups(0, 50);
            std::vector<glm::vec3> ours(lookups.directions.size());
            map.lookup(lookups.directions, lookups.parameters, ours);
            json input = input_of(lookups);
            input["define"] = "#define SHELL_COUNT " + std::to_string(map.shells().size()) + "\n#define SHELL_CUBIC " +
                              (filter == TexelFilter::cubic ? "1" : "0") + "\n#define SHELL_GGX " + (ggx ? "1" : "0") +
                              "\n";
            input["call"] = "shellLookup";
            for (const glm::vec4& shell : shell_uniforms(map, atlas))
                input["uniforms"]["shells"].push_back({shell.x, shell.y, shell.z, shell.w});
            input["uniforms"]["shellSpacing"] = {{map.first_power(), map.shells_a_power()}};
            input["texture"] = {{"name", "shellAtlas"},
                                {"width", atlas.width},
                                {"height", atlas.height},
                                {"depth", 0},
                                {"pixels", atlas_image(map, atlas).pixels}};
            const float largest = largest_difference("shell_map.glsl", input, ours);
            EXPECT_LT(255 * largest, 0.5f) << ggx << int(filter); // 8-bit weights of texture filters
            RecordProperty(std::string(ggx ? "ggx" : "phong") + (filter == TexelFilter::cubic ? "_cubic" : "_bilinear"),
                           std::to_string(255 * largest));
        }
}

TEST(MapShader, VoxelsAreLookedUpAsOnTheCpu) {
    if (!browser_is_there())
        GTEST_SKIP() << "skipped: the package chromium is missing (.ci/setup tests)";
    for (const SmoothnessRange range : {SmoothnessRange{0, 1}, {0.3, 0.6}}) { // whole, and cut off
        VoxelCube cube(LobeKind::phong, RoughnessScale::solved(16), range);
        cube.set_texels(smooth_texels(cube.layout()));
        const Lookups lookups = random_lookups(0, 1);
        std::vector<glm::vec3> ours(lookups.directions.size());
        cube.lookup(lookups.directions, lookups.parameters, ours);
        json input = input_of(lookups);
        input["define"] = "";
        input["call"] = "voxelLookup";
        input["uniforms"]["voxelRange"] = {{range.roughest, range.smoothest, cube.scale().cube_size() / 2.0}};
        std::vector<float> pixels;
        for (const glm::vec3& voxel : cube.voxels())
            pixels.insert(pixels.end(), {voxel.r, voxel.g, voxel.b});
        input["texture"] = {{"name", "voxelCube"},
                            {"width", cube.size()},
                            {"height", cube.size()},
                            {"depth", cube.size()},
                            {"pixels", pixels}};
        const float largest = largest_difference("voxel_cube.glsl", input, ours);
        EXPECT_LT(255 * largest, 0.5f) << range.smoothest;
        RecordProperty("largest_to_" + std::to_string(range.smoothest), std::to_string(255 * largest));
    }
}

TEST(MapShader, HorizonsAreCorrectedAsOnTheCpu) {
    if (!browser_is_there())
        GTEST_SKIP() << "skipped: the package chromium is missing (.ci/setup tests)";
    const glm::vec3 normal(0, 1, 0);
    for (const LobeKind kind : {LobeKind::phong, LobeKind::ggx}) {
        const bool ggx = kind == LobeKind::ggx;
        const HorizonTable table(kind);
        const Lookups lookups = ggx ? random_lookups(0.1f, 1) : random_lookups(0.3f, 300);
        std::vector<float> cells;
        for (const glm::vec4& cell : table.cells())
            cells.insert(cells.end(), {cell.x, cell.y, cell.z, cell.w});
        // A map whose radiance is a plain function of direction and width: what the shader and we have to agree on.
        const auto map = [&](const glm::vec3& d, float parameter) {
            return glm::vec3(0.5f + 0.5f * d.x, 0.5f + 0.5f * d.y, ggx ? parameter : 1 / std::sqrt(parameter + 1));
        };
        std::vector<glm::vec3> ours;
        for (std::size_t i = 0; i < lookups.directions.size(); ++i)
            ours.push_back(
                filtered_above_horizon(table, normal, lookups.directions[i], double(lookups.parameters[i]), map));
        json input = input_of(lookups);
        const std::string width = ggx ? "(p)" : "inversesqrt((p) + 1.0)";
        input["define"] = "#define HORIZON_GGX " + std::string(ggx ? "1" : "0") +
                          "\n#define MAP(d, p) vec3(0.5 + 0.5 * (d).xy, " + width +
                          ")\n#define SUM(h) (0.5 * (h).share * (MAP((h).first, (h).parameter) + "
                          "MAP((h).second, (h).parameter)))\n#define lookUp(d, p) "
                          "SUM(horizonLookup(vec3(0.0, 1.0, 0.0), d, p))\n";
        input["call"] = "lookUp";
        input["texture"] = {{"name", "horizonTable"},
                            {"width", HorizonTable::columns},
                            {"height", HorizonTable::rows},
                            {"depth", 0},
                            {"channels", 4},
                            {"pixels", cells}};
        EXPECT_LT(largest_difference("horizon.glsl", input, ours), 1e-3f) << ggx;
    }
}

} // namespace
} // namespace kokage

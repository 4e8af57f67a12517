// Lat-long images are read as three.js, a program that we did not write, reads them: the same file, the same
// directions.
#include "common/directions/sphere_sets.h"
#include "common/environment/load_environment.h"
#include "common/scene/image_file.h"
#include "tests/support/node.h"
#include "tests/support/program_run.h"

#include <nlohmann/json.hpp>

namespace kokage {
namespace {

/// A direction's colour tells the direction: 0.5 + 0.45 (x, y, z).
glm::vec3 color_of(const glm::dvec3& direction) {
    return glm::vec3(0.5 + 0.45 * direction);
}

Image directions_as_colors(int width, int height) {
    Image image(width, height, 3);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < 3; ++c)
                image.at(x, y)[c] = color_of(pixel_direction(x, y, width, height))[std::size_t(c)];
    return image;
}

std::vector<glm::dvec3> all_around() {
    std::vector<glm::dvec3> directions = fibonacci_sphere(60).directions;
    for (const glm::dvec3 axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0), glm::dvec3(0, 0, 1)}) {
        directions.push_back(axis);
        directions.push_back(-axis);
    }
    return directions;
}

glm::vec3 vector_of(const nlohmann::json& json) {
    return {float(json[0]), float(json[1]), float(json[2])};
}

TEST(LatLongThree, EveryFormatShowsTheSameInTheSameDirection) {
    const std::string modules = node_modules_with("three");
    if (modules.empty() || !browser_is_there())
        GTEST_SKIP() << "skipped: the npm package three or the package chromium is missing (.ci/setup tests)";
    TemporaryFolder folder;
    const std::vector<glm::dvec3> directions = all_around();
    nlohmann::json list = nlohmann::json::array();
    for (const glm::dvec3& d : directions)
        list.push_back({d.x, d.y, d.z});
    std::ofstream(folder / "directions.json") << list;
    // What the file's numbers keep: .png 8 bits of sRGB, .hdr 8 bits of mantissa; three.js computes with 16-bit floats.
    // A shift by half a pixel would be 0.0055.
    const std::vector<std::pair<std::string, float>> formats = {
        {"a.exr", 0.002f}, {"a.hdr", 0.004f}, {"a.png", 0.004f}};
    std::vector<std::string> arguments = {modules};
    for (const auto& [name, precision] : formats) {
        save_image(folder / name, directions_as_colors(256, 128));
        arguments.push_back(folder / name);
    }
    const nlohmann::json all_seen = run_node("lat_long.js", arguments, folder / "directions.json");
    ASSERT_EQ(all_seen.size(), formats.size());
    for (std::size_t f = 0; f < formats.size(); ++f) {
        const auto& [name, precision] = formats[f];
        const nlohmann::json& seen = all_seen[f];
        EnvironmentReport report;
        const Environment environment = load_environment(folder / name, report, {.split = false});
        ASSERT_EQ(seen["background"].size(), directions.size());
        float off = 0, off_diffuse = 0;
        for (std::size_t i = 0; i < directions.size(); ++i) {
            const glm::vec3 ours = lat_long_radiance(environment.remainder, glm::vec3(directions[i]));
            const glm::vec3 theirs = vector_of(seen["background"][i]);
            // Irradiance of 0.5 + 0.45 x over pi, by Funk and Hecke: 0.5 + 0.45 (2/3) n.
            const glm::vec3 diffuse(0.5 + 0.3 * directions[i]);
            // At the very poles our lookup stays in the first row of pixels, half a pixel away.
            const float tolerance = std::abs(directions[i].y) > 0.9999 ? 0.006f + precision : precision;
            for (int c = 0; c < 3; ++c) {
                off = std::max(off, std::abs(ours[c] - theirs[c]));
                off_diffuse = std::max(off_diffuse, std::abs(vector_of(seen["diffuse"][i])[c] - diffuse[c]));
                EXPECT_NEAR(ours[c], theirs[c], tolerance)
                    << name << " towards " << directions[i].x << ", " << directions[i].y << ", " << directions[i].z;
                EXPECT_NEAR(vector_of(seen["diffuse"][i])[c], diffuse[c], 0.01f) << name;
            }
        }
        RecordProperty(name.substr(2) + "_largest_difference", std::to_string(off));
        RecordProperty(name.substr(2) + "_largest_difference_reflected", std::to_string(off_diffuse));
    }
}

} // namespace
} // namespace kokage

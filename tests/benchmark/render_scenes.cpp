#include "tests/benchmark/render_scenes.h"
#include "common/services/output_file.h"

#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

namespace kokage {
namespace {

PlacedTree tree(const std::string& species, int leaves, const glm::dvec3& at, double turn, std::uint64_t seed) {
    PlacedTree placed;
    placed.source.name = species;
    placed.source.leaves = leaves;
    placed.seed = seed;
    placed.placement = {at, turn, 1};
    placed.pointer = "/trees";
    return placed;
}

SceneDescription scene(const std::string& name, int width, int height) {
    SceneDescription description;
    description.name = name;
    description.picture.width = width;
    description.picture.height = height;
    return description;
}

void look(SceneDescription& description, const glm::dvec3& from, const glm::dvec3& at) {
    description.camera.position = from;
    description.camera.target = at;
}

PlacedObject teapot(const std::filesystem::path& data, const std::filesystem::path& folder) {
    PlacedObject object;
    object.file = data / "objects/utah_teapot.obj";
    object.up = "z";
    if (data.empty() || !std::filesystem::exists(object.file)) {
        object.file = folder / "pot.obj";
        object.up = "y";
        std::ofstream(object.file) << turned_pot_obj();
    }
    object.height_m = 1.2;
    object.placement = {{1.8, 0, 2.0}, 30, 1};
    object.material = "glaze";
    object.pointer = "/objects/0";
    return object;
}

} // namespace

std::string turned_pot_obj() {
    // Radius and height from the foot to the knob's top.
    constexpr std::pair<double, double> kProfile[] = {
        {0, 0},       {0.6, 0},     {0.62, 0.03}, {0.8, 0.15}, {0.95, 0.35}, {1, 0.55},
        {0.95, 0.75}, {0.85, 0.95}, {0.72, 1.1},  {0.7, 1.15}, {0.6, 1.2},   {0.4, 1.27},
        {0.15, 1.32}, {0.1, 1.37},  {0.16, 1.45}, {0.16, 1.5}, {0.1, 1.56},  {0, 1.58}};
    constexpr int kAround = 64;
    std::ostringstream text;
    text << "o pot\n";
    for (const auto& [radius, height] : kProfile)
        for (int j = 0; j < kAround; ++j) {
            const double angle = 2 * 3.141592653589793 * j / kAround;
            text << "v " << radius * std::sin(angle) << ' ' << height << ' ' << radius * std::cos(angle) << '\n';
        }
    const auto vertex = [](std::size_t ring, int j) { return 1 + int(ring) * kAround + j % kAround; };
    for (std::size_t ring = 0; ring + 1 < std::size(kProfile); ++ring)
        for (int j = 0; j < kAround; ++j)
            text << "f " << vertex(ring, j) << ' ' << vertex(ring, j + 1) << ' ' << vertex(ring + 1, j + 1) << ' '
                 << vertex(ring + 1, j) << '\n';
    return text.str();
}

std::vector<SceneDescription> render_scenes(int width, int height, const std::filesystem::path& data,
                                            const std::filesystem::path& folder) {
    SceneDescription close = scene("close", width, height);
    close.trees = {tree("oak", 30000, {0, 0, 0}, 0, 1)};
    look(close, {4.5, 2.2, 5.5}, {0, 3.2, 0});

    SceneDescription pot = scene("teapot", width, height);
    pot.trees = {tree("maple", 20000, {0, 0, 0}, 20, 2)};
    pot.objects = {teapot(data, folder)};
    MaterialDescription& glaze = pot.materials["glaze"];
    glaze.base_color = glm::vec3(0.5f, 0.08f, 0.05f);
    glaze.roughness_from_foot_to_top = glm::dvec2(0.6, 0.15);
    look(pot, {3.2, 1.4, 7}, {1, 1.3, 0.5});

    SceneDescription five = scene("five", width, height);
    const std::pair<const char*, glm::dvec3> places[] = {{"oak", {-0.5, 0, -1}},
                                                         {"birch", {2.6, 0, -1}},
                                                         {"maple", {-3.6, 0, 0}},
                                                         {"pine", {5, 0, 1}},
                                                         {"cherry", {0.8, 0, 3}}};
    std::uint64_t seed = 0;
    for (const auto& [species, at] : places) {
        five.trees.push_back(tree(species, 8000, at, 40. * double(seed), seed + 1));
        ++seed;
    }
    look(five, {0.5, 2.5, 15.2}, {0.42, 2.15, 0}); // all five are in the picture
    return {close, pot, five};
}

} // namespace kokage

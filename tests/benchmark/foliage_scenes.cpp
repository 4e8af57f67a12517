#include "tests/benchmark/foliage_scenes.h"
#include "common/services/error.h"
#include "common/services/random.h"
#include "tests/benchmark/crown.h"
#include "tests/benchmark/environments.h"
#include "tests/benchmark/scene_hash.h"
#include "trees/patches.h"

namespace kokage {

namespace {

constexpr std::uint64_t kCrownSeed = 1;

PatchOptions patch_options(const BenchSceneName& name) {
    PatchOptions options;
    const glm::vec3 bark(0.15f, 0.10f, 0.07f);
    switch (name.material) {
    case BenchMaterial::realistic:
        options.leaf_optics = Optics{{0.10f, 0.25f, 0.06f}, {0.08f, 0.25f, 0.04f}};
        options.bark_albedo = bark;
        break;
    case BenchMaterial::bright:
        options.leaf_optics = Optics{glm::vec3(0.5f), glm::vec3(0.4f)};
        options.bark_albedo = bark;
        break;
    case BenchMaterial::white:
        // 0.625 + 0.375 is 1 exactly in binary, so the furnace does not cool by rounding.
        options.leaf_optics = Optics{glm::vec3(0.625f), glm::vec3(0.375f)};
        options.bark_albedo = glm::vec3(1.f);
        break;
    }
    if (name.light != BenchLight::furnace && name.light != BenchLight::lamp_lit)
        options.ground = Ground{0.f, glm::vec3(0.2f)};
    return options;
}

} // namespace

std::string_view bench_material_name(BenchMaterial material) {
    switch (material) {
    case BenchMaterial::realistic:
        return "realistic";
    case BenchMaterial::bright:
        return "bright";
    case BenchMaterial::white:
        return "white";
    }
    return "";
}

std::string_view bench_light_name(BenchLight light) {
    switch (light) {
    case BenchLight::sky_sun:
        return "sky-sun";
    case BenchLight::sky_sun_relit:
        return "sky-sun-relit";
    case BenchLight::lamp_lit:
        return "lamp-lit";
    case BenchLight::one_light:
        return "one-light";
    case BenchLight::many_lights:
        return "64-lights";
    case BenchLight::point_light:
        return "point-light";
    case BenchLight::furnace:
        return "furnace";
    }
    return "";
}

std::string to_string(const BenchSceneName& name) {
    return std::to_string(name.leaves) + "-" + std::string(bench_material_name(name.material)) + "-" +
           std::string(bench_light_name(name.light));
}

BenchScenes::BenchScenes(std::filesystem::path data_folder) : data_folder_(std::move(data_folder)) {}

std::string BenchScenes::why_not(const BenchSceneName& name) const {
    if (name.light != BenchLight::lamp_lit)
        return "";
    if (data_folder_.empty())
        return "the lamp-lit scenes need " + lamp_lit_file({}).string() +
               ": set KOKAGE_DATA or --data to the data folder";
    if (!std::filesystem::exists(lamp_lit_file(data_folder_)))
        return lamp_lit_file(data_folder_).string() + " does not exist: set KOKAGE_DATA or --data to the data folder";
    return "";
}

BenchScene BenchScenes::make(const BenchSceneName& name) {
    if (const std::string reason = why_not(name); !reason.empty())
        throw InputError(reason);
    BenchScene scene{name, crown(name.leaves), {}, environment(name.light), {}};
    scene.patches = make_patches(*scene.tree, patch_options(name));
    const std::vector<double> areas = solid_areas(scene.patches);
    scene.leaf_areas.assign(scene.patches.leaf_count, 0.0);
    for (std::size_t p = 0; p < areas.size(); ++p)
        if (scene.patches.patches[p].kind == PatchKind::leaf)
            scene.leaf_areas[scene.patches.patches[p].leaf] += areas[p];
    return scene;
}

std::shared_ptr<const Tree> BenchScenes::crown(std::uint32_t leaves) {
    for (const auto& [count, tree] : crowns_)
        if (count == leaves)
            return tree;
    crowns_.emplace_back(leaves, std::make_shared<const Tree>(make_bench_crown(leaves, kCrownSeed)));
    return crowns_.back().second;
}

std::shared_ptr<const Environment> BenchScenes::environment(BenchLight light) {
    for (const auto& [known, environment] : environments_)
        if (known == light)
            return environment;
    environments_.emplace_back(light, std::make_shared<const Environment>(make_bench_environment(light, data_folder_)));
    return environments_.back().second;
}

std::uint64_t scene_hash(const BenchScene& scene) {
    return hash64(geometry_hash(scene.patches) ^ hash64(environment_hash(*scene.environment)));
}

} // namespace kokage

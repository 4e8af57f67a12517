#include "tests/cycles/cross_check_scenes.h"
#include "common/environment/analytic_sky.h"
#include "common/environment/light_description.h"
#include "common/environment/load_environment.h"
#include "common/obj/obj_scene.h"
#include "common/services/error.h"
#include "foliage/solution.h"
#include "trees/growth.h"
#include "trees/read_tree.h"
#include "viewer/scene/shaded_scene.h"

#include <algorithm>

namespace kokage {
namespace {

CrossCheckScene scene_of(const Tree& tree, const PatchOptions& options) {
    CrossCheckScene scene;
    PatchOrigins origins;
    scene.patches = make_patches(tree, options, &origins);
    ShadedScene shaded = shaded_scene(tree, scene.patches, origins, Solution{});
    scene.normals = std::move(shaded.normals);
    scene.looks = std::move(shaded.looks);
    scene.triangle_look = std::move(shaded.triangle_look);
    return scene;
}

Tree grown(const char* species, int leaves) {
    GrowthParameters parameters = find_species(species).parameters;
    parameters.leaves = leaves;
    return grow(parameters);
}

PatchOptions bright_leaves() {
    PatchOptions options;
    options.leaf_optics = Optics{glm::vec3(0.5f), glm::vec3(0.4f)};
    return options;
}

/// Adds opaque triangles as one patch.
void add_body(CrossCheckScene& scene, const std::vector<glm::vec3>& positions, const std::vector<glm::vec3>& normals,
              const std::vector<glm::uvec3>& triangles, const glm::vec3& albedo, bool smooth) {
    PatchScene& patches = scene.patches;
    const auto first = std::uint32_t(patches.positions.size()),
               first_triangle = std::uint32_t(patches.triangles.size());
    patches.positions.insert(patches.positions.end(), positions.begin(), positions.end());
    scene.normals.insert(scene.normals.end(), normals.begin(), normals.end());
    if (!patches.uvs.empty())
        patches.uvs.resize(patches.positions.size(), glm::vec2(0.f));
    for (const glm::uvec3& triangle : triangles)
        patches.triangles.push_back(triangle + first);
    patches.triangle_patch.resize(patches.triangles.size(), std::uint32_t(patches.patches.size()));
    if (!patches.triangle_mask.empty())
        patches.triangle_mask.resize(patches.triangles.size(), -1);
    patches.patches.push_back(
        {first_triangle, std::uint32_t(triangles.size()), std::uint32_t(patches.optics.size()), PatchKind::bark, 0});
    patches.optics.push_back({albedo, glm::vec3(0.f)});
    scene.triangle_look.resize(patches.triangles.size(), std::uint32_t(scene.looks.size()));
    SurfaceLook look;
    look.smooth_normals = smooth;
    scene.looks.push_back(std::move(look));
}

/// A square of ground as a surface: the renderer's own ground varies where the camera sees it, and fades into haze.
void add_square(CrossCheckScene& scene, float half_edge, float height, const glm::vec3& albedo) {
    const float e = half_edge, h = height;
    add_body(scene, {{-e, h, -e}, {-e, h, e}, {e, h, e}, {e, h, -e}}, std::vector(4, glm::vec3(0, 1, 0)),
             {{0, 1, 2}, {0, 2, 3}}, albedo, false);
}

void add_teapot(CrossCheckScene& scene, const std::filesystem::path& file, float height, const glm::vec3& foot,
                const glm::vec3& albedo) {
    const MeshScene teapot = read_obj_scene(file);
    glm::vec3 low(1e30f), high(-1e30f);
    for (const SceneMesh& mesh : teapot.meshes)
        for (const glm::vec3& p : mesh.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
    const float scale = height / (high.y - low.y);
    const glm::vec3 middle(0.5f * (low.x + high.x), low.y, 0.5f * (low.z + high.z));
    for (const SceneMesh& mesh : teapot.meshes) {
        std::vector<glm::vec3> positions;
        for (const glm::vec3& p : mesh.positions)
            positions.push_back(foot + scale * (p - middle));
        add_body(scene, positions, mesh.normals, mesh.triangles, albedo, true);
    }
}

std::filesystem::path needed(const std::filesystem::path& data, const char* name) {
    if (data.empty() || !std::filesystem::exists(data / name))
        throw InputError(std::string("it needs ") + name + " in the folder that KOKAGE_DATA names");
    return data / name;
}

} // namespace

ShadedScene CrossCheckScene::shaded() const {
    ShadedScene scene;
    scene.patches = &patches;
    scene.normals = normals;
    scene.looks = looks;
    scene.triangle_look = triangle_look;
    scene.indirect_front.assign(patches.patches.size(), glm::vec3(0.f));
    scene.indirect_back = scene.radiance_front = scene.radiance_back = scene.indirect_front;
    return scene;
}

CrossCheckScene small_scene() {
    CrossCheckScene scene = scene_of(grown("maple", 200), bright_leaves());
    scene.name = "small";
    scene.description = "a maple of 200 bright leaves on a square of ground, sun and gradient";
    const Bounds bounds = bounds_of(scene.patches);
    add_square(scene, bounds.diagonal(), 0.f, glm::vec3(0.6f, 0.5f, 0.3f));
    scene.environment = gradient_environment({0.25f, 0.45f, 0.9f}, {0.8f, 0.85f, 0.9f}, {0.12f, 0.1f, 0.08f});
    add_light(scene.environment, "disc:120,40,4,3.6,3,5");
    scene.camera = frame_scene(bounds, 1.f);
    return scene;
}

CrossCheckScene oak_in_the_open() {
    CrossCheckScene scene = scene_of(grown("oak", 4000), bright_leaves());
    scene.name = "oak";
    scene.description = "an oak of 4000 bright leaves, nothing below it, constant sky";
    scene.environment = constant_environment(glm::vec3(1.f));
    scene.camera = frame_scene(scene.patches, 4.f / 3);
    return scene;
}

CrossCheckScene under_a_maple() {
    PatchOptions options;
    options.ground = Ground{.height_m = 0, .albedo = {0.4f, 0.35f, 0.2f}};
    CrossCheckScene scene = scene_of(grown("maple", 6000), options);
    scene.name = "maple";
    scene.description = "a maple of 6000 leaves from below, on endless ground, sun of its true size and gradient";
    scene.environment = gradient_environment({0.25f, 0.45f, 0.9f}, {0.8f, 0.85f, 0.9f}, {0.f, 0.f, 0.f});
    add_light(scene.environment, "sun:130,35,6,5.4,4.5");
    const Bounds bounds = bounds_of(scene.patches);
    const float height = bounds.high.y;
    scene.camera.position = {0.55f * height, 0.12f * height, 0.45f * height};
    scene.camera.target = {0, 0.62f * height, 0};
    scene.camera.vertical_field_of_view = 0.75f;
    return scene;
}

CrossCheckScene cards_and_teapot(const std::filesystem::path& data) {
    const Tree tree = read_tree(needed(data, "trees/eztree_oak_medium.glb"), {}, silent_progress());
    CrossCheckScene scene = scene_of(tree, {});
    scene.name = "cards";
    scene.description =
        "ez-tree's oak of alpha-masked cards and a smooth teapot on a square of ground, photograph with a sun";
    const Bounds bounds = bounds_of(scene.patches);
    const float size = bounds.diagonal(), foot = bounds.low.y;
    add_teapot(scene, needed(data, "objects/utah_teapot.obj"), 0.16f * size, {0.22f * size, foot, 0.3f * size},
               {0.7f, 0.45f, 0.3f});
    add_square(scene, size, foot, {0.3f, 0.28f, 0.18f});
    EnvironmentReport report;
    scene.environment =
        load_environment(needed(data, "env/sky_clouds_sun.hdr"), report, EnvironmentLoading{.max_width = 1024});
    scene.camera = frame_scene(bounds, 4.f / 3);
    return scene;
}

} // namespace kokage

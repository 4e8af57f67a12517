#include "tests/cycles/cycles_picture.h"
#include "common/scene/image_file.h"
#include "common/services/error.h"
#include "reflection/camera_rays.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <tuple>

namespace kokage {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

Json json_of(const glm::vec3& v) {
    return {v.x, v.y, v.z};
}

template <typename Value>
void write_array(const fs::path& path, const std::vector<Value>& values) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(Value)));
    if (!file.flush())
        throw std::runtime_error("can't write " + path.string());
}

const char* extension_of(TextureWrap u, TextureWrap v) {
    if (u != v || u == TextureWrap::mirror)
        throw InputError("cycles: a texture repeats differently along its sides, or mirrored, which Blender 3.4 can't");
    return u == TextureWrap::repeat ? "REPEAT" : "EXTEND";
}

/// The base colour over its mean, texel by texel: what the patches' optics are multiplied with.
Image factor_of(const SurfaceLook& look) {
    const Image& texture = *look.base_color_texture;
    Image factor(texture.width, texture.height, 3);
    for (int y = 0; y < texture.height; ++y)
        for (int x = 0; x < texture.width; ++x)
            for (std::size_t c = 0; c < 3; ++c)
                factor.at(x, y)[c] = look.mean_base_color[c] > 0
                                         ? look.base_color[c] * texture.at(x, y)[c] / look.mean_base_color[c]
                                         : 1.f;
    return factor;
}

/// 1 where the surface is solid, else 0: the cutoff is decided here, so that nothing lies between.
Image solid_texels(const AlphaMask& mask) {
    Image solid(mask.alpha->width, mask.alpha->height, 3);
    for (int y = 0; y < solid.height; ++y)
        for (int x = 0; x < solid.width; ++x)
            std::fill_n(solid.at(x, y), 3, mask.alpha->at(x, y)[0] >= mask.cutoff ? 1.f : 0.f);
    return solid;
}

/// What decides how a triangle scatters: optics, look, mask; -1: none.
using MaterialKey = std::tuple<std::uint32_t, int, int>;

MaterialKey key_of(const ShadedScene& scene, std::size_t triangle) {
    const PatchScene& patches = *scene.patches;
    return {patches.patches[patches.triangle_patch[triangle]].optics,
            scene.looks.empty() ? -1 : int(scene.triangle_look[triangle]),
            patches.triangle_mask.empty() ? -1 : int(patches.triangle_mask[triangle])};
}

Json write_material(const ShadedScene& scene, const MaterialKey& key, std::size_t number, const fs::path& folder) {
    const auto& [optics, look_number, mask_number] = key;
    const Optics& scattering = scene.patches->optics[optics];
    Json material{{"reflectance", json_of(scattering.reflectance)},
                  {"transmittance", json_of(scattering.transmittance)}};
    if (mask_number >= 0) {
        const AlphaMask& mask = scene.patches->masks[std::size_t(mask_number)];
        const std::string name = "mask_" + std::to_string(number) + ".exr";
        save_image(folder / name, solid_texels(mask));
        material["mask"] = name;
        material["mask_extension"] = extension_of(mask.wrap_u, mask.wrap_v);
    }
    if (look_number < 0)
        return material;
    const SurfaceLook& look = scene.looks[std::size_t(look_number)];
    if (!look.gloss.is_matt())
        throw InputError("cycles: gloss; its GGX is another than our lobe about the mirrored direction");
    if (look.base_color_texture && !scene.patches->uvs.empty()) {
        const std::string name = "texture_" + std::to_string(number) + ".exr";
        save_image(folder / name, factor_of(look));
        material["texture"] = name;
        material["extension"] = extension_of(look.wrap_u, look.wrap_v);
    }
    return material;
}

Json write_surfaces(const ShadedScene& scene, const fs::path& folder) {
    const PatchScene& patches = *scene.patches;
    std::map<MaterialKey, std::uint32_t> numbers;
    Json materials = Json::array();
    std::vector<std::uint32_t> triangle_material, triangle_smooth;
    for (std::size_t t = 0; t < patches.triangles.size(); ++t) {
        const MaterialKey key = key_of(scene, t);
        const auto [place, is_new] = numbers.emplace(key, std::uint32_t(numbers.size()));
        if (is_new)
            materials.push_back(write_material(scene, key, place->second, folder));
        triangle_material.push_back(place->second);
        triangle_smooth.push_back(!scene.looks.empty() && !scene.normals.empty() &&
                                  scene.looks[scene.triangle_look[t]].smooth_normals);
    }
    static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::vec2) == 8 && sizeof(glm::uvec3) == 12);
    write_array(folder / "positions.f32", patches.positions);
    write_array(folder / "triangles.u32", patches.triangles);
    write_array(folder / "uvs.f32", patches.uvs);
    write_array(folder / "normals.f32", scene.normals);
    write_array(folder / "triangle_material.u32", triangle_material);
    write_array(folder / "triangle_smooth.u32", triangle_smooth);
    return materials;
}

/// Remainder and bright regions in one image, at most a pixel of the remainder to a pixel; finer than a coarse one, so
/// that Blender's seams at the poles and the wrap don't show.
Image surroundings_of(const Environment& environment) {
    Image whole = environment.remainder;
    for (const DistantLight& light : environment.distant_lights)
        for (const DistantLight::Texel& texel : light.texels) {
            const glm::vec2 uv = lat_long_from_direction(texel.direction);
            const int x = std::clamp(int(uv.x * float(whole.width)), 0, whole.width - 1);
            const int y = std::clamp(int(uv.y * float(whole.height)), 0, whole.height - 1);
            for (std::size_t c = 0; c < 3; ++c)
                whole.at(x, y)[c] += texel.irradiance[c] / float(pixel_solid_angle(y, whole.width, whole.height));
        }
    const int width = std::max(whole.width, 1024);
    if (whole.width == width)
        return whole;
    Image fine(width, width / 2, 3);
    for (int y = 0; y < fine.height; ++y)
        for (int x = 0; x < fine.width; ++x) {
            const glm::vec3 radiance =
                lat_long_radiance(whole, glm::vec3(pixel_direction(x, y, fine.width, fine.height)));
            for (std::size_t c = 0; c < 3; ++c)
                fine.at(x, y)[c] = radiance[c];
        }
    return fine;
}

Json suns_of(const Environment& environment) {
    if (!environment.point_lights.empty())
        throw InputError("cycles: point lights are not handed over");
    Json suns = Json::array();
    for (const DistantLight& light : environment.distant_lights) {
        if (!light.texels.empty())
            continue; // in the image
        if (!(light.half_angle > 0))
            throw InputError("cycles: the light '" + light.name + "' has no size");
        suns.push_back({{"direction", json_of(light.direction)},
                        {"half_angle", light.half_angle},
                        {"irradiance", json_of(light.irradiance)}});
    }
    return suns;
}

Json json_of(const Camera& camera, const CyclesOptions& options) {
    const CameraFrame frame = camera_frame(camera, options.width, options.height);
    return {{"position", json_of(frame.position)},
            {"forward", json_of(frame.forward)},
            {"right", json_of(glm::normalize(frame.right))},
            {"up", json_of(glm::normalize(frame.up))},
            {"vertical_field_of_view", camera.vertical_field_of_view}};
}

void run_blender(const fs::path& folder) {
    const fs::path log = folder / "blender.log";
    const std::string command = std::string("blender --background --factory-startup --python-exit-code 1 --python '") +
                                KOKAGE_CYCLES_FOLDER + "/render_in_cycles.py' -- '" + folder.string() + "' > '" +
                                log.string() + "' 2>&1";
    if (std::system(command.c_str()) == 0)
        return;
    std::ifstream file(log);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    throw std::runtime_error("Blender failed: ..." +
                             text.substr(text.size() - std::min<std::size_t>(1500, text.size())));
}

SurfaceLight load_picture(const fs::path& path) {
    const Image loaded = load_image(path, {.channels = 4});
    SurfaceLight light{Image(loaded.width, loaded.height, 3), Image(loaded.width, loaded.height, 1)};
    for (int y = 0; y < loaded.height; ++y)
        for (int x = 0; x < loaded.width; ++x) {
            const float* pixel = loaded.at(x, y); // alpha is straight here
            light.coverage.at(x, y)[0] = pixel[3];
            for (std::size_t c = 0; c < 3; ++c)
                light.radiance.at(x, y)[c] = pixel[c] * pixel[3];
        }
    return light;
}

} // namespace

std::optional<std::string> why_no_blender() {
    if (std::system("blender --version >/dev/null 2>&1") != 0)
        return "Blender is not installed (apt-get install blender python3-numpy)";
    return {};
}

std::vector<SurfaceLight> render_in_cycles(const ShadedScene& scene, const Environment& environment,
                                           const Camera& camera, const CyclesOptions& options, const fs::path& folder) {
    Json description{{"materials", write_surfaces(scene, folder)},
                     {"environment", "environment.exr"},
                     {"suns", suns_of(environment)},
                     {"camera", json_of(camera, options)},
                     {"width", options.width},
                     {"height", options.height},
                     {"samples", options.samples},
                     {"threads", options.threads}};
    if (const auto& ground = scene.patches->ground)
        description["ground"] = {
            {"height", ground->height_m}, {"albedo", json_of(ground->albedo)}, {"half_edge", 10000}};
    save_image(folder / "environment.exr", surroundings_of(environment));
    std::vector<std::string> names;
    for (int i = 0; i < options.pictures; ++i)
        names.push_back("cycles_" + std::to_string(i) + ".exr");
    description["pictures"] = names;
    std::ofstream(folder / "scene.json") << description.dump(1) << '\n';
    run_blender(folder);
    std::vector<SurfaceLight> pictures;
    for (const std::string& name : names)
        pictures.push_back(load_picture(folder / name));
    return pictures;
}

} // namespace kokage

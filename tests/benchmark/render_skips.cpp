#include "tests/benchmark/render_skips.h"
#include "common/scene/image_file.h"
#include "common/services/random.h"
#include "common/services/stopwatch.h"
#include "tests/benchmark/markdown.h"
#include "tests/benchmark/render_scenes.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace kokage {
namespace {

constexpr int kSamples = 8, kRuns = 3;

struct SkipCase {
    std::string what;
    std::string said; ///< by which the report's line about it begins
    SceneDescription scene;
    std::function<void(RenderOptions&)> switch_off;
    bool of_loading = false; ///< switched off while the scene is put together, which is timed too
};

SceneDescription matt(SceneDescription scene) {
    scene.name += ", matt";
    scene.materials["matt"].index_of_refraction = 1;
    for (PlacedTree& tree : scene.trees)
        tree.leaf_material = tree.bark_material = "matt";
    return scene;
}

/// So few leaves that their light is checked, unless it is gathered.
SceneDescription young(SceneDescription scene) {
    scene.name += ", 2,000 leaves";
    scene.trees[0].source.leaves = 2000;
    return scene;
}

/// One trunk of several, close by.
SceneDescription at_a_trunk(SceneDescription scene) {
    scene.name += ", a trunk close by";
    scene.camera.position = scene.trees[0].placement.at + glm::dvec3(0, 1.2, 2);
    scene.camera.target = scene.trees[0].placement.at + glm::dvec3(0, 1.2, 0);
    return scene;
}

/// Forty dim lamps all around, each a hundred-thousandth to a thousandth of the sun.
SceneDescription lamp_lit(SceneDescription scene) {
    scene.name += ", 40 lamps";
    for (int k = 0; k < 40; ++k)
        scene.surroundings.lights.push_back("directional:" + std::to_string(9 * k) + "," +
                                            std::to_string(10 + 17 * k % 70) + "," +
                                            std::to_string(4e-3 * std::pow(10., -k / 20.)));
    return scene;
}

std::filesystem::path unworn_texture(const std::filesystem::path& folder) {
    return folder / "unworn.png";
}

/// A material that nothing wears, of the size of those that are downloaded. What an image shows is no matter to its
/// loading, but that it can't be compressed to nothing is.
SceneDescription with_unworn_textures(SceneDescription scene, const std::filesystem::path& folder) {
    constexpr int kSize = 2048;
    scene.name += ", an unworn material of " + std::to_string(kSize) + "² texels";
    Image noise(kSize, kSize, 3);
    Random random(1, 0);
    for (float& value : noise.pixels)
        value = random.uniform();
    MaterialDescription& unworn = scene.materials["unworn"];
    unworn.pointer = "/materials/unworn";
    unworn.base_color_texture = unworn.roughness_texture = unworn_texture(folder);
    save_image(unworn.base_color_texture, noise);
    return scene;
}

std::vector<SkipCase> cases(int width, int height, const std::filesystem::path& data,
                            const std::filesystem::path& folder) {
    const std::vector<SceneDescription> scenes = render_scenes(width, height, data, folder);
    return {
        {"reflection map where all is matt", "reflection map", matt(scenes[0]),
         [](RenderOptions& o) { o.picture.skips.bake_of_matt = false; }},
        {"roughness that nothing in view has", "reflection map of other", scenes[0],
         [](RenderOptions& o) { o.picture.skips.lobes_out_of_view = false; }},
        {"relief below a quarter of a pixel", "relief", scenes[2],
         [](RenderOptions& o) { o.picture.skips.thin_relief = false; }},
        {"light maps that nothing reads", "light maps", matt(scenes[0]),
         [](RenderOptions& o) { o.skip_unread_light_maps = false; }},
        {"light maps elsewhere than bark in view reads", "light maps elsewhere", at_a_trunk(scenes[2]),
         [](RenderOptions& o) { o.skip_unread_light_maps = false; }},
        {"paths that check what is gathered", "check of the leaves", young(scenes[0]),
         [](RenderOptions& o) { o.skip_check_by_paths = false; }},
        {"weak lights", "", lamp_lit(scenes[0]), [](RenderOptions& o) { o.merge_weak_lights = false; }},
        {"textures that nothing wears", "1 material", with_unworn_textures(scenes[1], folder), nullptr, true},
    };
}

std::string said_about(const SkipCase& skip, const WorkReport& report) {
    for (const WorkReport::Skip& line : report.skips) {
        const bool is_of_lights = skip.said.empty() && line.what.find("weak light") != std::string::npos;
        if (is_of_lights || (!skip.said.empty() && line.what.rfind(skip.said, 0) == 0))
            return line.what + ": " + line.why;
    }
    return "nothing was left out";
}

/// `loaded`: the scene; null: it is put together in each run, which is timed as well.
PictureRecord draw(const SkipCase& skip, const AssembledScene* loaded, bool on, Progress& progress, Image& radiance) {
    AssemblyOptions assembly;
    RenderOptions options;
    options.picture = skip.scene.picture;
    options.picture.samples = kSamples;
    if (!on && skip.of_loading)
        assembly.skip_unworn_materials = false;
    else if (!on)
        skip.switch_off(options);
    PictureRecord record;
    record.scene = skip.scene.name;
    record.method = "skip: " + skip.what;
    record.effort = on ? "on" : "off";
    record.width = options.picture.width;
    record.height = options.picture.height;
    record.samples = kSamples;
    record.error = options.error;
    for (int run = 0; run < kRuns; ++run) {
        const Stopwatch whole;
        std::optional<AssembledScene> own;
        if (!loaded)
            own = assemble_scene(skip.scene, progress, assembly);
        const AssembledScene& scene = loaded ? *loaded : *own;
        const RenderedScene rendered = render_scene(scene, options, progress);
        const double seconds = whole.cpu();
        record.cpu_seconds = run == 0 ? seconds : std::min(record.cpu_seconds, seconds);
        radiance = rendered.picture.radiance;
        if (on)
            record.note = said_about(skip, skip.of_loading ? scene.report : rendered.report);
    }
    return record;
}

double change(const Image& on, const Image& off) {
    double sum = 0, mean = 0;
    for (std::size_t i = 0; i < off.pixels.size(); ++i) {
        sum += std::abs(double(on.pixels[i]) - double(off.pixels[i]));
        mean += double(off.pixels[i]);
    }
    return mean > 0 ? sum / mean : 0;
}

struct RemovedAtEnd {
    std::filesystem::path file;
    ~RemovedAtEnd() {
        std::error_code ignored;
        std::filesystem::remove(file, ignored);
    }
};

} // namespace

void measure_skips(const RenderPlan& plan, const std::filesystem::path& data, const std::filesystem::path& folder,
                   Progress& progress, const std::function<void(const PictureRecord&)>& take) {
    const RemovedAtEnd texture{unworn_texture(folder)};
    for (const SkipCase& skip : cases(plan.width / 2, plan.height / 2, data, folder)) {
        std::optional<AssembledScene> loaded;
        if (!skip.of_loading)
            loaded = assemble_scene(skip.scene, progress);
        const AssembledScene* scene = loaded ? &*loaded : nullptr;
        Image with, without;
        PictureRecord on = draw(skip, scene, true, progress, with);
        const PictureRecord off = draw(skip, scene, false, progress, without);
        on.change_by_skip = change(with, without);
        take(on);
        take(off);
    }
}

std::string skip_table(const std::vector<PictureRecord>& records) {
    std::string text = markdown_row({"what is left out", "scene", "CPU s with it left out", "CPU s without",
                                     "change of the picture %", "what the report says"}) +
                       markdown_row(std::vector<std::string>(6, "---"));
    for (std::size_t i = 0; i + 1 < records.size(); i += 2) {
        const PictureRecord &on = records[i], &off = records[i + 1];
        text += markdown_row({on.method.substr(on.method.find(' ') + 1), on.scene, three_digits(on.cpu_seconds),
                              three_digits(off.cpu_seconds), three_digits(on.change_by_skip, 100), on.note});
    }
    return text;
}

} // namespace kokage

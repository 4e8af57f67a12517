#include "viewer/render_options.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "viewer/scene/data_folder.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/read_scene.h"
#include "viewer/scene/values.h"
#include "viewer/shared_options.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace kokage {
namespace fs = std::filesystem;
namespace {

void add_picture_options(CLI::App& app, RenderCommandOptions& o) {
    app.add_option(
           "-o,--output", o.outputs,
           "The picture: .png as it is looked at, .exr the light itself with its layers (albedo, normal, depth, "
           "direct, indirect, reflection, leaf); may be repeated (otherwise NAME.png here)")
        ->type_name("PIC.png")
        ->allow_extra_args(false)
        ->group("Picture");
    app.add_option("--size", o.size, "Its size (otherwise the scene's, or 1280x960)")
        ->type_name("WxH")
        ->group("Picture");
    add_samples_option(app, o.samples, " (otherwise the scene's, or 16)")->group("Picture");
    add_exposure_option(app, o.exposure_stops, "the scene's, or metered as a camera does", ".exr")->group("Picture");
    add_report_option(app, o.report)->group("Picture");
}

void add_render_method_options(CLI::App& app, RenderCommandOptions& o) {
    app.add_option("--method", o.method,
                   "fast, or path-traced: the truth, whose noise falls with --samples (four times as many: half)")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Method");
    add_error_option(app, o.error,
                     "fast: mean relative error of the leaves' light to aim at (otherwise 0.15 for 15 %; pixels err "
                     "less, as they add up many leaves)")
        ->group("Method");
    app.add_option(
           "--gather-rays", o.gather_rays,
           "fast: rays a pixel that gather light anew where the camera looks (otherwise a quarter of --samples, "
           "1 to 16; 0: leaves show their mean light)")
        ->check(CLI::Range(0, 1024).description(""))
        ->type_name("N")
        ->group("Method");
    app.add_option("--seed", o.seed, "Seed of random numbers (another tree: --set seed=N)")
        ->check(whole_number())
        ->type_name("N")
        ->group("Method");
}

RenderMethod method_of(const std::string& name) {
    if (name == "fast")
        return RenderMethod::fast;
    if (name == "path-traced")
        return RenderMethod::path_traced;
    throw InputError("--method: '" + name + "' is not known; give fast or path-traced");
}

/// What a scene says itself.
void refuse_tree_options(const CLI::App& app, const fs::path& scene) {
    for (const char* option :
         {"--leaves", "--set", "--foliage", "--leaf-size", "--scale", "--up", "--environment", "--sun", "--turbidity",
          "--light", "--strict", "--ground", "--no-ground", "--ground-albedo"})
        if (app.get_option(option)->count() > 0)
            throw InputError(std::string(option) + ": it is for a single tree; the scene '" + scene.string() +
                             "' says such things itself: change them there");
}

SceneDescription described_scene(const CLI::App& app, RenderCommandOptions& o) {
    if (is_scene_file(o.tree.name)) {
        refuse_tree_options(app, o.tree.name);
        return read_scene(o.tree.name, o.data);
    }
    std::error_code ignored;
    if (lower_ending(o.tree.name) == ".json" && !fs::is_regular_file(o.tree.name, ignored))
        throw InputError("'" + o.tree.name + "' " +
                         (fs::is_directory(o.tree.name, ignored) ? "is a folder" : "is not there") +
                         "; give a scene or a species file (.json); 'kokage render --example' prints a scene");
    check_tree_source(o.tree);
    check_surroundings(o.surroundings, o.data);
    SceneDescription scene = scene_of_tree(o.tree);
    scene.surroundings = o.surroundings;
    if (o.surroundings.ground == false)
        scene.picture.ground = PictureGround::none;
    if (app.get_option("--strict")->count() > 0 && !is_environment_image(o.surroundings))
        scene.warnings.push_back(
            "--strict changes nothing here: the environment is no image whose pixels could be refused");
    return scene;
}

std::vector<fs::path> files_of(const SceneDescription& scene) {
    std::vector<fs::path> files = {scene.file, fs::path(scene.surroundings.environment)};
    for (const PlacedTree& tree : scene.trees)
        files.push_back(tree.source.file());
    for (const PlacedObject& object : scene.objects)
        files.push_back(object.file);
    for (const auto& [name, material] : scene.materials) {
        files.push_back(material.base_color_texture);
        files.push_back(material.roughness_texture);
        if (material.relief) {
            files.push_back(material.relief->heights);
            files.push_back(material.relief->normals);
        }
    }
    return files;
}

bool is_exr(const fs::path& file) {
    return lower_ending(file) == ".exr";
}

void complete_outputs(RenderCommandOptions& o, const SceneDescription& scene) {
    if (o.outputs.empty())
        o.outputs = {scene.name + ".png"};
    check_exposure(o.exposure_stops, o.outputs);
    for (const fs::path& output : o.outputs)
        check_output(output, "the picture", {".png", ".exr"});
    if (!o.report.empty())
        check_output(o.report, "the report", {".json"});
    for (std::size_t i = 0; i < o.outputs.size(); ++i) {
        check_distinct({o.report, o.outputs[i]});
        for (std::size_t j = 0; j < i; ++j)
            check_distinct({o.outputs[i], o.outputs[j]});
    }
    for (const fs::path& input : files_of(scene)) {
        check_distinct({input, o.report});
        for (const fs::path& output : o.outputs)
            check_distinct({input, output});
    }
}

/// The scene's own, where the command line says nothing else.
PictureOptions picture_options(const RenderCommandOptions& o, const SceneDescription& scene) {
    PictureOptions picture = scene.picture;
    if (!o.size.empty()) {
        const Size size = size_from(o.size, "--size");
        picture.width = size.width;
        picture.height = size.height;
    }
    picture.samples = o.samples.value_or(picture.samples);
    picture.seed = o.seed.value_or(picture.seed);
    if (o.exposure_stops)
        picture.exposure_stops = o.exposure_stops;
    picture.gather_rays = o.gather_rays;
    picture.layers = std::any_of(o.outputs.begin(), o.outputs.end(), is_exr);
    return picture;
}

} // namespace

bool is_scene_file(const fs::path& file) {
    std::error_code ignored;
    if (lower_ending(file) != ".json" || !fs::is_regular_file(file, ignored))
        return false;
    const std::vector<unsigned char> bytes = read_file_bytes(file, std::uint64_t(1) << 26);
    const auto json = nlohmann::json::parse(bytes, nullptr, false, true);
    return !json.is_object() || json.contains("kokage_scene") ||
           !(json.contains("name") || json.contains("parameters"));
}

void add_render_options(CLI::App& app, RenderCommandOptions& o) {
    app.add_option(
           "SCENE", o.tree.name,
           "A scene (.json), or just a tree: a species or species file (.json) to grow, or a tree's file (.glb, "
           ".gltf, .obj)")
        ->type_name("NAME")
        ->capture_default_str();
    add_data_option(app, o.data, "SCENE, files that it names, and --environment are");
    app.add_flag("--example", o.prints_example, "Print a scene to start from, with comments");
    app.add_flag("--schema", o.prints_schema,
                 "Print the JSON Schema of scenes, with which editors complete and check them");
    add_picture_options(app, o);
    add_render_method_options(app, o);
    add_growing_options(app, o.tree);
    add_loading_options(app, o.tree);
    add_surroundings_options(app, o.surroundings);
}

CompleteRender complete_render_options(const CLI::App& app, RenderCommandOptions& o) {
    find_in_data(o.data, {&o.tree.name, &o.surroundings.environment});
    CompleteRender complete;
    complete.options.method = method_of(o.method);
    if (o.error && complete.options.method == RenderMethod::path_traced)
        throw InputError("--error: path-traced has none but its noise, which falls with --samples; leave it out");
    if (o.gather_rays && complete.options.method == RenderMethod::path_traced)
        throw InputError("--gather-rays: path-traced follows every path to its end; leave it out");
    check_error(o.error);
    complete.options.error = o.error.value_or(complete.options.error);
    complete.scene = described_scene(app, o);
    complete_outputs(o, complete.scene);
    complete.options.picture = picture_options(o, complete.scene);
    complete.scene.picture = complete.options.picture;
    return complete;
}

} // namespace kokage

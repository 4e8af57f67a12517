#include "viewer/shade_options.h"
#include "common/services/error.h"
#include "viewer/scene/data_folder.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/values.h"
#include "viewer/shade_lods.h"
#include "viewer/shared_options.h"

namespace kokage {
namespace fs = std::filesystem;
namespace {

void add_method_options(CLI::App& app, ShadeOptions& o) {
    app.add_option("--method", o.method,
                   "bundles (line bundles: fast and accurate), light-maps, path-traced (the truth) or paper")
        ->type_name("NAME")
        ->capture_default_str()
        ->group("Method");
    add_error_option(app, o.error,
                     "Mean relative error of the leaves to aim at, from which the effort follows (otherwise 0.05)")
        ->group("Method");
    app.add_option("--effort", o.effort,
                   "The effort itself, in place of --error: bundles and light-maps: directions of lines; "
                   "path-traced: paths a leaf side; 0 = the method's own")
        ->type_name("N")
        ->group("Method");
    app.add_option("--maps", o.maps,
                   "Light-environment maps: paper (otherwise 15) and light-maps (otherwise 100) shade by them; bundles "
                   "only writes them to OUT.glb for programs that read them (otherwise 15)")
        ->type_name("N")
        ->group("Method");
    app.add_option("--bands", o.bands, "Bands of spherical harmonics of such a map, 1 to 40 (otherwise 7)")
        ->type_name("N")
        ->group("Method");
    app.add_option("--gather", o.gather,
                   "light-maps: how a leaf reads maps: cosine (two-sided cosine; the default) or rule (the paper's "
                   "equations 2 and 3)")
        ->type_name("NAME")
        ->group("Method");
    app.add_option("--bounces", o.shading.max_bounces, "Most bounces of light; 0 = until they no longer matter")
        ->type_name("N")
        ->capture_default_str()
        ->group("Method");
    app.add_option("--seed", o.shading.seed, "Seed of the method's random numbers (another tree: --set seed=N)")
        ->check(whole_number())
        ->type_name("N")
        ->capture_default_str()
        ->group("Method");
}

void add_material_options(CLI::App& app, ShadeOptions& o) {
    const auto color = [&](const char* name, std::string& value, const char* what) {
        app.add_option(name, value, std::string(what) + ", one number or R,G,B (otherwise the material's own)")
            ->type_name("COLOR")
            ->group("Material");
    };
    color("--leaf-reflectance", o.leaf_reflectance, "What leaves reflect");
    color("--leaf-transmittance", o.leaf_transmittance, "What leaves let through");
    color("--bark-albedo", o.bark_albedo, "What bark reflects");
}

void add_output_options(CLI::App& app, ShadeOptions& o) {
    app.add_option("-o,--output", o.output, "The shaded tree")->type_name("OUT.glb")->group("Output");
    app.add_flag("--split-sides", o.split_sides,
                 "Write every leaf as two single-sided sheets, for viewers that show one colour a leaf")
        ->group("Output");
    app.add_option("--image", o.image, "A picture: .png, or linear radiance as .exr or .hdr")
        ->type_name("PIC.png")
        ->group("Output");
    app.add_option("--image-size", o.image_size, "Its size")->type_name("WxH")->capture_default_str()->group("Output");
    add_samples_option(app, o.picture.samples)->capture_default_str()->group("Output");
    add_exposure_option(app, o.picture.exposure_stops, "automatic", ".exr and .hdr")->group("Output");
    app.add_option("--lods", o.lods,
                   "Levels of detail in this folder: three coarser trees that keep leaf area and light, an impostor of "
                   "four cards, a picture and figures of each one's error")
        ->type_name("FOLDER")
        ->group("Output");
    add_report_option(app, o.report)->group("Output");
}

/// What would change nothing is a misunderstanding: better said than swallowed.
void refuse_idle_options(const ShadeOptions& o) {
    const Method method = o.shading.method;
    const std::string name(method_name(method));
    if (o.effort && method == Method::paper)
        throw InputError("--effort: the paper's method has none; its --maps and --bounces can be chosen");
    if (o.gather && method != Method::light_maps)
        throw InputError("--gather: it shapes light-maps alone, and would change nothing with " + name +
                         "; leave it out, or give --method light-maps");
    for (const auto& [option, given] : {std::pair("--maps", o.maps.has_value()), {"--bands", o.bands.has_value()}}) {
        if (given && method == Method::path_traced)
            throw InputError(std::string(option) + ": path-traced uses no light maps, so it would change nothing; " +
                             "leave it out, or choose another --method");
        if (given && method == Method::bundles && o.output.empty() && o.lods.empty())
            throw InputError(std::string(option) +
                             ": bundles does not shade by light maps, it only writes them to the shaded tree, which "
                             "is not written; add -o OUT.glb, or give --method light-maps");
    }
}

void complete_method(ShadeOptions& o) {
    ShadingOptions& s = o.shading;
    s.for_hosts = !o.output.empty() || !o.lods.empty(); // the file takes light maps along
    s.method = method_from_name(o.method);
    refuse_idle_options(o);
    s.effort = o.effort.value_or(s.effort);
    constexpr int kMostDirections = 20480;
    if (s.method == Method::bundles && o.effort && (s.effort < 4 || s.effort > kMostDirections))
        throw InputError("--effort: bundles takes 4 to " + std::to_string(kMostDirections) + " directions, not " +
                         std::to_string(s.effort));
    s.maps = o.maps.value_or(s.maps);
    s.bands = o.bands.value_or(s.bands);
    if (o.gather && *o.gather != "rule" && *o.gather != "cosine")
        throw InputError("--gather: '" + *o.gather + "' is not known; give rule or cosine");
    s.gather = o.gather == "rule" ? GatherRule::rule : GatherRule::cosine;
    if (o.error && s.method == Method::paper)
        throw InputError("--error: the paper's method can't aim at an error; leave it out, or choose another --method");
    if (o.error && s.method == Method::light_maps)
        throw InputError(
            "--error: light-maps can't see its own error; give --effort (directions of lines) and --maps instead");
    if (o.error && s.effort > 0)
        throw InputError("--error and --effort contradict one another; leave one of them out");
    check_error(o.error);
    s.error = o.error.value_or(0.05);
    if (s.effort < 0 || s.maps < 0 || s.max_bounces < 0)
        throw InputError("--effort, --maps and --bounces can't be negative");
    if (s.bands < 1 || s.bands > 40)
        throw InputError("--bands: " + std::to_string(s.bands) + " is not from 1 to 40");
}

void complete_materials(const ShadeOptions& o) {
    glm::vec3 sum(0.f);
    if (!o.leaf_reflectance.empty())
        sum += color_from(o.leaf_reflectance, "--leaf-reflectance");
    if (!o.leaf_transmittance.empty())
        sum += color_from(o.leaf_transmittance, "--leaf-transmittance");
    if (glm::any(glm::greaterThan(sum, glm::vec3(1.f + 1e-6f))))
        throw InputError("--leaf-reflectance and --leaf-transmittance add up to more than 1: leaves would give more "
                         "light than they get");
    if (!o.bark_albedo.empty())
        color_from(o.bark_albedo, "--bark-albedo");
}

/// With none named, all three are written, called after the tree; otherwise those that are named.
void name_outputs(ShadeOptions& o) {
    if (!o.output.empty() || !o.image.empty() || !o.report.empty() || !o.lods.empty())
        return;
    // Beside a file of one's own, "oak.glb" would be overwritten.
    const std::string stem = o.tree.stem() + (o.tree.is_species() ? "" : "-shaded");
    o.output = stem + ".glb";
    o.image = stem + ".png";
    o.report = stem + ".json";
}

void complete_outputs(ShadeOptions& o) {
    const Size size = size_from(o.image_size, "--image-size");
    o.picture.width = size.width;
    o.picture.height = size.height;
    o.picture.seed = o.shading.seed;
    o.picture.gather_rays = 0; // it shows what was solved
    check_exposure(o.picture.exposure_stops, o.image.empty() ? std::vector<fs::path>() : std::vector{o.image});
    if (o.surroundings.ground == false)
        o.picture.ground = PictureGround::none;
    if (!o.output.empty())
        check_output(o.output, "the shaded tree", {".glb"});
    else if (o.split_sides && o.lods.empty())
        throw InputError("--split-sides shapes the shaded tree, which is not written; add -o OUT.glb");
    if (!o.image.empty())
        check_output(o.image, "the picture", {".png", ".exr", ".hdr"});
    if (!o.report.empty())
        check_output(o.report, "the report", {".json"});
    if (!o.lods.empty())
        check_lod_folder(o.lods);
    const fs::path tree = o.tree.file();
    check_distinct({tree, o.output, o.image, o.report});
    check_distinct({fs::path(o.surroundings.environment), o.output, o.image, o.report});
}

} // namespace

void add_shade_options(CLI::App& app, ShadeOptions& o) {
    app.add_option("TREE", o.tree.name,
                   "A species or species file (.json) to grow, or a tree's file (.glb, .gltf, .obj)")
        ->type_name("NAME")
        ->capture_default_str();
    add_data_option(app, o.data, "TREE and --environment are");
    add_growing_options(app, o.tree);
    add_loading_options(app, o.tree);
    add_surroundings_options(app, o.surroundings);
    add_method_options(app, o);
    add_material_options(app, o);
    add_output_options(app, o);
}

void complete_shade_options(ShadeOptions& o) {
    find_in_data(o.data, {&o.tree.name, &o.surroundings.environment});
    name_outputs(o);
    complete_method(o);
    complete_materials(o);
    check_tree_source(o.tree);
    check_surroundings(o.surroundings, o.data);
    complete_outputs(o);
}

void override_optics(const ShadeOptions& o, PatchScene& scene) {
    std::optional<glm::vec3> reflectance, transmittance, bark;
    if (!o.leaf_reflectance.empty())
        reflectance = color_from(o.leaf_reflectance, "--leaf-reflectance");
    if (!o.leaf_transmittance.empty())
        transmittance = color_from(o.leaf_transmittance, "--leaf-transmittance");
    if (!o.bark_albedo.empty())
        bark = color_from(o.bark_albedo, "--bark-albedo");
    for (const Patch& patch : scene.patches) {
        Optics& optics = scene.optics[patch.optics];
        if (patch.kind == PatchKind::bark) {
            optics.reflectance = bark.value_or(optics.reflectance);
            continue;
        }
        optics.reflectance = reflectance.value_or(optics.reflectance);
        optics.transmittance = transmittance.value_or(optics.transmittance);
        if (glm::any(glm::greaterThan(optics.reflectance + optics.transmittance, glm::vec3(1.f + 1e-6f))))
            throw InputError(
                "a leaf's reflectance and transmittance add up to more than 1 with the material's own other half; "
                "give both --leaf-reflectance and --leaf-transmittance");
    }
}

} // namespace kokage

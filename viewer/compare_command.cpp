// `kokage compare`: how far two pictures, two reflection maps or two shadings of a tree are apart.
#include "common/scene/image_file.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "reflection/compare_images.h"
#include "viewer/command.h"
#include "viewer/compare_layers.h"
#include "viewer/compare_maps.h"
#include "viewer/compare_trees.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/values.h"
#include "viewer/stop_signal.h"
#include "viewer/write_json.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

namespace kokage {
namespace {
using Json = nlohmann::ordered_json;

struct CompareOptions {
    std::filesystem::path picture, reference, error_map, report;
};

void print_figures(const char* what, const DifferenceFigures& f, double unit) {
    std::printf("%-20s mean %.4g, RMS %.4g, 95 %% below %.4g, largest %.4g, bias %+.4g\n", what, unit * f.mean,
                unit * f.rms, unit * f.p95, unit * f.max, unit * f.bias);
}

/// null for what is undefined.
Json json_of(const std::optional<double>& figure) {
    return figure ? Json(*figure) : Json();
}

constexpr const char* kUndefined = "undefined, B is black";

Json figures_json(const DifferenceFigures& f) {
    return {{"mean", f.mean}, {"rms", f.rms},   {"p95", f.p95},
            {"max", f.max},   {"bias", f.bias}, {"mean_relative", json_of(f.relative)}};
}

/// What a report says of the error map.
Json map_json(const std::filesystem::path& path, const char* shows, double scale, const std::string& legend) {
    return {{"file", path.string()}, {"shows", shows}, {"brightest_at", scale}, {"colours", legend}};
}

void print_map(const CommandContext& context, const std::filesystem::path& path, const char* shows,
               const std::string& legend) {
    if (!context.quiet)
        std::printf("error map: %s (%s: %s)\n", path.c_str(), shows, legend.c_str());
}

std::string kind_text(const ImageHeader& header) {
    return header.is_linear ? "linear radiance" : "display colours of " + std::to_string(header.bits) + " bits";
}

/// Empty if the numbers of both files mean the same.
std::string unlike_warning(const CompareOptions& options) {
    const ImageHeader a = image_header(options.picture), b = image_header(options.reference);
    if (a.is_linear == b.is_linear)
        return "";
    return "'" + options.picture.string() + "' holds " + kind_text(a) + ", '" + options.reference.string() + "' " +
           kind_text(b) +
           " (exposed, tone-mapped, cut off at 1): their numbers mean different things, so these figures "
           "say little; compare two of one kind";
}

Image clamped(Image image) {
    for (float& value : image.pixels)
        value = std::clamp(value, 0.f, 1.f);
    return image;
}

void print_layer(const LayerComparison& layer) {
    if (layer.difference)
        print_figures(layer.name.c_str(), *layer.difference, 1);
    if (layer.differing_share)
        std::printf("%-20s differs in %.4g %% of the pixels\n", layer.name.c_str(), 100 * *layer.differing_share);
    const auto left_out = [](std::size_t pixels, const std::string& where) {
        if (pixels > 0)
            std::printf("%-20s %s %s, in no figure\n", "", counted(pixels, "pixel", "pixels").c_str(), where.c_str());
    };
    left_out(layer.pixels_finite_in_one, "where only one picture is finite");
    left_out(layer.pixels_finite_in_none, "where neither picture is finite");
    std::array<char, 64> horizon;
    std::snprintf(horizon.data(), horizon.size(), "farther than %.3g m (the horizon)", layer.horizon_m);
    left_out(layer.pixels_at_horizon, horizon.data());
}

Json layer_json(const LayerComparison& layer) {
    Json json = layer.difference ? figures_json(*layer.difference) : Json::object();
    if (layer.difference) {
        json["pixels_finite_in_one"] = layer.pixels_finite_in_one;
        json["pixels_finite_in_none"] = layer.pixels_finite_in_none;
    }
    if (layer.pixels_at_horizon > 0) {
        json["pixels_at_horizon"] = layer.pixels_at_horizon;
        json["horizon_m"] = layer.horizon_m;
    }
    if (layer.differing_share)
        json["differing_share"] = *layer.differing_share;
    return json;
}

void compare_pictures(const CompareOptions& options, const CommandContext& context) {
    // As stored, without alpha: 8-bit pictures are compared as they are shown, float pictures as radiance.
    const ImageLoading as_stored{.meaning = PixelMeaning::data, .channels = 3};
    const Image picture = load_image(options.picture, as_stored), reference = load_image(options.reference, as_stored);
    const std::string unlike = unlike_warning(options);
    if (!unlike.empty())
        std::fprintf(stderr, "kokage: warning: %s\n", unlike.c_str());
    const ImageComparison whole = compare_images(picture, reference);
    const ImageComparison shown = compare_images(clamped(picture), clamped(reference));
    if (whole.all.relative)
        std::printf("%-20s %.4g %%\n", "mean relative error", 100 * *whole.all.relative);
    else
        std::printf("%-20s %s\n", "mean relative error", kUndefined);
    print_figures("error", whole.all, 1);
    print_figures("error of 256", shown.all, 255);
    std::printf("%-20s x %d, y %d\n", "largest error at", whole.max_x, whole.max_y);
    if (whole.skipped_values > 0)
        std::printf("not finite, in no figure: %s\n", counted(whole.skipped_values, "value", "values").c_str());
    const std::vector<LayerComparison> layers = compare_layers(options.picture, options.reference);
    if (!layers.empty())
        std::printf("these figures are of the radiance; layer by layer:\n");
    for (const LayerComparison& layer : layers)
        print_layer(layer);
    const char* shows = "largest difference of each pixel's channels";
    const std::string legend = error_legend_text(double(whole.map_scale), 1, "");
    if (!options.error_map.empty()) {
        save_image(options.error_map, whole.map, {.png_encoding = PngEncoding::as_is});
        print_map(context, options.error_map, shows, legend);
    }
    if (!options.report.empty()) {
        Json report = {{"picture", options.picture.string()},
                       {"reference", options.reference.string()},
                       {"error", figures_json(whole.all)},
                       {"error_of_1_clamped", figures_json(shown.all)},
                       {"largest_error_at", {whole.max_x, whole.max_y}},
                       {"values_not_finite", whole.skipped_values},
                       {"warnings", unlike.empty() ? Json::array() : Json::array({unlike})}};
        for (const LayerComparison& layer : layers)
            report["layers"][layer.name] = layer_json(layer);
        if (!options.error_map.empty())
            report["error_map"] = map_json(options.error_map, shows, double(whole.map_scale), legend);
        write_json(options.report, report);
    }
}

void compare_trees(const CompareOptions& options, const CommandContext& context) {
    const TreeComparison c =
        compare_trees(options.picture, options.reference, !options.error_map.empty(), *context.progress);
    context.progress->clear();
    std::printf("leaves                %s\n", count_text(c.leaves).c_str());
    std::printf("mean relative error   %.4g %%, 95 %% below %.4g %%\n", 100 * c.accuracy.mre, 100 * c.accuracy.p95);
    std::printf("RMSE / mean           %.4g %%\n", 100 * c.accuracy.rmse_over_mean);
    std::printf("bias                  %+.4g %%\n", 100 * c.accuracy.bias);
    std::printf("largest error         %.4g %%, of leaf %zu\n", 100 * c.largest, c.largest_leaf);
    const WritingFiles writing;
    const char* shows = "relative error of each leaf side";
    const std::string legend = error_legend_text(c.map_scale, 100, " %");
    if (!options.error_map.empty()) {
        save_image(options.error_map, c.map, {.png_encoding = PngEncoding::as_is});
        print_map(context, options.error_map, shows, legend + "; bark is grey");
    }
    if (!options.report.empty()) {
        Json report = {{"shaded", options.picture.string()},
                       {"reference", options.reference.string()},
                       {"leaves", c.leaves},
                       {"mre", c.accuracy.mre},
                       {"p95", c.accuracy.p95},
                       {"rmse_over_mean", c.accuracy.rmse_over_mean},
                       {"bias", c.accuracy.bias},
                       {"largest", c.largest},
                       {"largest_leaf", c.largest_leaf}};
        if (!options.error_map.empty())
            report["error_map"] = map_json(options.error_map, shows, c.map_scale, legend);
        write_json(options.report, report);
    }
}

Json difference_json(const MapDifference& d) {
    return {{"mean_error_255", d.mean_255},
            {"max_error_255", d.max_255},
            {"mean_error", d.mean_absolute},
            {"max_error", d.max_absolute},
            {"mean_relative_error", json_of(d.mean_relative)},
            {"max_relative_error", json_of(d.max_relative)},
            {"worst_direction", {d.worst_direction.x, d.worst_direction.y, d.worst_direction.z}}};
}

void print_difference(const char* what, const MapDifference& d) {
    std::printf("%-20s of 256: mean %.4g, largest %.4g; ", what, d.mean_255, d.max_255);
    if (d.max_relative)
        std::printf("relative: mean %.4g %%, largest %.4g %%\n", 100 * *d.mean_relative, 100 * *d.max_relative);
    else
        std::printf("radiance: mean %.4g, largest %.4g; relative: %s\n", d.mean_absolute, d.max_absolute, kUndefined);
}

void compare_reflection_maps(const CompareOptions& options, const CommandContext& context) {
    const FilteredMap map = load_reflection_map(options.picture), reference = load_reflection_map(options.reference);
    const MapComparison c = compare_maps(map, reference);
    std::printf("%-20s %s\n%-20s %s\n", "A", map.description.c_str(), "B", reference.description.c_str());
    for (const MapComparison::OfLobe& lobe : c.lobes) {
        char name[40];
        std::snprintf(name, sizeof name, "%s %.4g", map.kind == LobeKind::ggx ? "roughness" : "exponent",
                      lobe.parameter);
        print_difference(name, lobe.difference);
    }
    print_difference("all", c.all);
    const WritingFiles writing;
    const char* shows = "largest difference of the channels in every direction, rough lobes at the top";
    std::string legend;
    double map_scale = 0;
    if (!options.error_map.empty()) {
        const ImageComparison pictures = compare_images(pictures_of_map(map, c), pictures_of_map(reference, c));
        map_scale = double(pictures.map_scale);
        legend = error_legend_text(map_scale, 1, "");
        save_image(options.error_map, pictures.map, {.png_encoding = PngEncoding::as_is});
        print_map(context, options.error_map, shows, legend);
    }
    if (!options.report.empty()) {
        Json lobes = Json::array();
        for (const MapComparison::OfLobe& lobe : c.lobes) {
            lobes.push_back(difference_json(lobe.difference));
            lobes.back()["parameter"] = lobe.parameter;
        }
        Json report = {{"map", options.picture.string()},         {"map_is", map.description},
                       {"reference", options.reference.string()}, {"reference_is", reference.description},
                       {"lobe", lobe_kind_name(map.kind)},        {"directions", c.directions},
                       {"error", difference_json(c.all)},         {"lobes", lobes}};
        if (!options.error_map.empty())
            report["error_map"] = map_json(options.error_map, shows, map_scale, legend);
        write_json(options.report, report);
    }
}

bool is_tree(const std::filesystem::path& path) {
    const std::string ending = lower_ending(path);
    return ending == ".glb" || ending == ".gltf";
}

} // namespace

Command compare_command(CLI::App& program) {
    const auto options = std::make_shared<CompareOptions>();
    CLI::App* app = program.add_subcommand(
        "compare", "Error figures and an error map of two pictures, reflection maps or shadings of a tree");
    app->footer("\nExample: kokage compare fast.png truth.png -o errors.png");
    app->add_option("A", options->picture,
                    "What is judged: a picture (.png, .exr, .hdr, .jpg, ...; of an .exr with layers its radiance, and "
                    "each layer), a reflection map (.exr of kokage bake, "
                    ".ktx2, .dds) or a tree shaded by kokage (.glb)")
        ->required()
        ->type_name("FILE");
    app->add_option("B", options->reference, "The reference, of the same kind")->required()->type_name("FILE");
    app->add_option("-o,--error-map", options->error_map, "Where to write the errors in false colours")
        ->type_name("MAP.png");
    app->add_option("--report", options->report, "Where to write the figures")->type_name("FILE.json");
    return {app, [options](const CommandContext& context) {
                if (!options->error_map.empty())
                    check_output(options->error_map, "the error map", {".png"});
                if (!options->report.empty())
                    check_output(options->report, "the report", {".json"});
                check_distinct({options->picture, options->error_map, options->report});
                check_distinct({options->reference, options->error_map, options->report});
                for (const std::filesystem::path& file : {options->picture, options->reference})
                    if (!std::filesystem::exists(file))
                        throw InputError("there is no file '" + file.string() + "'");
                for (const std::filesystem::path& file : {options->picture, options->reference})
                    if (lower_ending(file) == ".json")
                        throw InputError("'" + file.string() +
                                         "' holds no picture, map or tree; spherical harmonics can't be compared here");
                const bool tree = is_tree(options->picture), map = !tree && is_reflection_map(options->picture);
                if (tree != is_tree(options->reference) || map != is_reflection_map(options->reference))
                    throw InputError("'" + options->picture.string() + "' and '" + options->reference.string() +
                                     "' are not of one kind; compare two shaded trees, two reflection maps, or two "
                                     "pictures");
                if (tree)
                    compare_trees(*options, context);
                else if (map)
                    compare_reflection_maps(*options, context);
                else
                    compare_pictures(*options, context);
            }};
}

} // namespace kokage

// `kokage render`: scene -> picture, as .png and as .exr with layers.
#include "common/scene/image_file.h"
#include "common/scene/image_layers.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "viewer/command.h"
#include "viewer/print_file.h"
#include "viewer/render_options.h"
#include "viewer/render_report.h"
#include "viewer/scene/scene_texts.h"
#include "viewer/scene/stage_clock.h"
#include "viewer/scene/values.h"
#include "viewer/stop_signal.h"
#include "viewer/write_json.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

/// The picture itself first; each layer's images are moved out of it.
std::vector<ImageLayer> layers_of(Picture& picture) {
    const std::vector<std::string> color = {"R", "G", "B"};
    std::vector<ImageLayer> layers = {{"", color, std::move(picture.radiance)}};
    if (!picture.layers)
        return layers;
    PictureLayers& p = *picture.layers;
    layers.push_back({"albedo", color, std::move(p.albedo)});
    layers.push_back({"normal", {"X", "Y", "Z"}, std::move(p.normal)});
    layers.push_back({"depth", {"Z"}, std::move(p.depth)});
    layers.push_back({"direct", color, std::move(p.direct)});
    layers.push_back({"indirect", color, std::move(p.indirect)});
    layers.push_back({"reflection", color, std::move(p.reflection)});
    layers.push_back({"leaf", {"id"}, std::move(p.leaf)});
    return layers;
}

/// Layers are taken out of the picture: .exr come last.
void write_pictures(const RenderCommandOptions& options, Picture& picture, float exposure_stops) {
    for (const std::filesystem::path& output : options.outputs)
        if (lower_ending(output) == ".png")
            save_image(output, tone_map(picture.radiance, exposure_stops, &picture.subject),
                       {.png_encoding = PngEncoding::as_is});
    std::vector<ImageLayer> layers;
    for (const std::filesystem::path& output : options.outputs) {
        if (lower_ending(output) == ".png")
            continue;
        if (layers.empty())
            layers = layers_of(picture);
        save_layers(output, layers);
    }
}

/// How much of the picture its subject fills, and how bright that is.
void describe_subject(const Picture& picture, RenderRecord& record) {
    double share = 0, luminance = 0;
    for (std::size_t i = 0; i < picture.subject.pixels.size(); ++i) {
        const float* rgb = &picture.radiance.pixels[3 * i];
        const double weight = double(picture.subject.pixels[i]);
        share += weight;
        luminance += weight * (0.2126 * double(rgb[0]) + 0.7152 * double(rgb[1]) + 0.0722 * double(rgb[2]));
    }
    record.subject_share = share / double(picture.subject.pixels.size());
    record.subject_radiance = share > 0 ? luminance / share : 0;
}

void print_summary(const RenderCommandOptions& options, const RenderRecord& record) {
    const SceneDescription& description = *record.description;
    const AssembledScene& scene = *record.scene;
    const PictureOptions& picture = record.options.picture;
    std::printf("%s: ", shown_name(description.name).c_str());
    if (!description.trees.empty())
        std::printf("%s, ", counted(description.trees.size(), "tree", "trees").c_str());
    if (!description.objects.empty())
        std::printf("%s, ", counted(description.objects.size(), "object", "objects").c_str());
    std::printf("%s, %s; %s\n", counted(scene.tree.leaves.size(), "leaf", "leaves").c_str(),
                counted(scene.patches.patches.size(), "patch", "patches").c_str(),
                scene.environment.description.c_str());
    std::printf("%s: %d x %d pixels, %s a pixel, exposure %+.2f stops%s\n", render_method_name(record.options.method),
                picture.width, picture.height, counted(std::size_t(picture.samples), "ray", "rays").c_str(),
                record.exposure_stops, picture.exposure_stops ? "" : " (metered)");
    for (const WorkReport::Stage& stage : record.work.stages)
        std::printf("  %-12s %10s  (CPU %s)\n", stage.name.c_str(), duration_text(stage.wall_seconds).c_str(),
                    duration_text(stage.cpu_seconds).c_str());
    std::printf("  %-12s %10s  (CPU %s)\n", "in all", duration_text(record.wall_seconds).c_str(),
                duration_text(record.cpu_seconds).c_str());
    for (const WorkReport::Skip& skip : record.work.skips)
        std::printf("left out: %s: %s%s%s\n", skip.what.c_str(), skip.why.c_str(), skip.saved.empty() ? "" : "; saves ",
                    skip.saved.c_str());
    for (const std::filesystem::path& file : options.outputs)
        print_file(file);
    if (!options.report.empty())
        print_file(options.report);
}

void render(const CLI::App& app, RenderCommandOptions& options, const CommandContext& context) {
    RenderRecord record;
    for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->count() > 0; }))
        for (const std::string& value : option->results())
            record.arguments.emplace_back(option->get_name(), value);
    const Stopwatch watch;
    StageClock before, after;
    const CompleteRender complete = before.run("read", [&] { return complete_render_options(app, options); });

    const AssembledScene scene = assemble_scene(complete.scene, *context.progress);
    context.progress->throw_if_stopped();
    RenderedScene rendered = render_scene(scene, complete.options, *context.progress);
    context.progress->throw_if_stopped();

    record.description = &complete.scene;
    record.scene = &scene;
    record.options = complete.options;
    const float exposure = after.run("meter", [&] {
        describe_subject(rendered.picture, record);
        return complete.options.picture.exposure_stops.value_or(
            automatic_exposure_stops(rendered.picture.radiance, &rendered.picture.subject));
    });
    record.exposure_stops = double(exposure);
    record.work.warnings = complete.scene.warnings;
    record.work.stages = before.stages();
    record.work.append(scene.report);
    record.work.append(rendered.report);
    record.picture = rendered.picture.report;
    const WritingFiles writing;
    after.run("write", [&] {
        context.progress->begin("writing", 0);
        write_pictures(options, rendered.picture, exposure);
    });
    record.work.stages.insert(record.work.stages.end(), after.stages().begin(), after.stages().end());
    record.cpu_seconds = watch.cpu();
    record.wall_seconds = watch.wall();
    for (const std::filesystem::path& output : options.outputs)
        record.outputs.emplace_back("picture", output.string());
    if (!options.report.empty()) {
        record.outputs.emplace_back("report", options.report.string());
        write_json(options.report, render_report(record));
    }
    context.progress->clear();
    for (const std::string& warning : record.work.warnings)
        std::fprintf(stderr, "kokage: warning: %s\n", warning.c_str());
    if (!context.quiet)
        print_summary(options, record);
}

void run_render(const CLI::App& app, RenderCommandOptions& options, const CommandContext& context) {
    if (options.prints_schema && options.prints_example)
        throw InputError("--schema and --example print different things; leave one of them out");
    if (!options.prints_schema && !options.prints_example)
        return render(app, options, context);
    const std::string_view text = options.prints_schema ? scene_schema_text() : scene_example_text();
    std::fwrite(text.data(), 1, text.size(), stdout);
}

} // namespace

Command render_command(CLI::App& program) {
    const auto options = std::make_shared<RenderCommandOptions>();
    CLI::App* app = program.add_subcommand("render", "Draw a scene of trees and objects, or just a tree");
    app->footer(
        "\nExamples: kokage render --example > avenue.json && kokage render avenue.json -o avenue.png -o "
        "avenue.exr\n          kokage render birch --sun 250,12 --size 1600x1200\nA scene says what stands where "
        "under which light (viewer/scene/README.md); with just a tree, options say it.");
    add_render_options(*app, *options);
    return {app, [app, options](const CommandContext& context) { run_render(*app, *options, context); }};
}

} // namespace kokage

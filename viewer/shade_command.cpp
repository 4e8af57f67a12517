// `kokage shade`: tree + surroundings -> the light on every leaf, as glTF, picture and report.
#include "common/scene/image_file.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/write_tree.h"
#include "viewer/command.h"
#include "viewer/print_file.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/shaded_scene.h"
#include "viewer/scene/stage_clock.h"
#include "viewer/scene/values.h"
#include "viewer/shade_lods.h"
#include "viewer/shade_options.h"
#include "viewer/shading_report.h"
#include "viewer/stop_signal.h"
#include "viewer/write_json.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

/// Everything between the options and the files.
struct Shading {
    Tree tree;
    Environment environment;
    EnvironmentReport environment_report;
    PatchScene patches;
    PatchOrigins origins;
    Solution solution;
    std::optional<Picture> picture;
    std::vector<std::string> warnings;
};

Picture draw(const Shading& shading, const ShadeOptions& options, Progress& progress) {
    ShadedScene scene = shaded_scene(shading.tree, shading.patches, shading.origins, shading.solution);
    scene.foot_height = foot_height(shading.tree);
    const RayQueries queries(shading.patches);
    const float aspect = float(options.picture.width) / float(options.picture.height);
    const Camera camera = frame_scene(shading.patches, aspect, photographers_azimuth(shading.environment));
    return render_picture(scene, queries, shading.environment, camera, options.picture, progress);
}

void shade(const ShadeOptions& options, Shading& s, StageClock& clock, Progress& progress) {
    s.tree =
        clock.run(options.tree.is_species() ? "grow" : "load", [&] { return obtain_tree(options.tree, progress); });
    progress.throw_if_stopped();
    s.environment = clock.run(
        "environment", [&] { return obtain_environment(options.surroundings, s.tree.origin, s.environment_report); });
    s.warnings = s.environment_report.warnings;
    if (const std::optional<std::string> warning = no_foliage_warning(s.tree, "--foliage NAME"))
        s.warnings.push_back(*warning);
    if (const std::optional<std::string> night = night_warning(options.surroundings))
        s.warnings.push_back(*night);
    s.patches = clock.run("patches", [&] {
        PatchOptions patch_options;
        patch_options.ground = obtain_ground(options.surroundings, s.environment, s.tree);
        if (patch_options.ground)
            for (const std::string& hidden :
                 drop_hidden_lights(options.surroundings, s.environment, *patch_options.ground))
                s.warnings.push_back(hidden);
        s.environment.description += added_lights_text(options.surroundings, s.environment);
        PatchScene scene = make_patches(s.tree, patch_options, &s.origins);
        override_optics(options, scene);
        return scene;
    });
    progress.throw_if_stopped();
    const std::unique_ptr<Transport> transport =
        clock.run("transport", [&] { return make_transport(s.patches, s.tree, options.shading, progress); });
    s.solution = clock.run("solve", [&] { return transport->solve(s.environment, progress); });
    if (s.tree.leaves.empty())
        s.solution.estimated_error.reset(); // an error over no leaves would read as success
    if (s.solution.energy_in == 0)
        s.warnings.push_back("no light reaches the tree, and all of it is black: give --environment or --light that "
                             "shines on it");
    progress.throw_if_stopped();
    if (!options.image.empty())
        s.picture = clock.run("picture", [&] { return draw(s, options, progress); });
    progress.throw_if_stopped();
}

void write_shaded_tree(const ShadeOptions& options, const Shading& s, Progress& progress) {
    const Solution& solution = s.solution;
    const ShadedAttributes attributes{.radiance_front = solution.radiance.front,
                                      .radiance_back = solution.radiance.back,
                                      .indirect_front = solution.indirect.front,
                                      .indirect_back = solution.indirect.back,
                                      .light_maps = solution.light_maps};
    write_tree(options.output, s.tree, &attributes, {.split_sides = options.split_sides}, progress);
}

void write_picture(const ShadeOptions& options, const Picture& picture) {
    if (lower_ending(options.image) == ".png")
        save_image(options.image, tone_map(picture.radiance, options.picture.exposure_stops, &picture.subject),
                   {.png_encoding = PngEncoding::as_is});
    else
        save_image(options.image, picture.radiance);
}

/// " (asked for 5 %)" where an error was asked for.
std::string asked_text(const ShadingOptions& options) {
    char text[48] = "";
    if (options.effort == 0)
        std::snprintf(text, sizeof text, " (asked for %.3g %%)", 100 * options.error);
    return text;
}

/// The errors of the levels of detail, as in their report, and where they are.
void print_lods(const WrittenLods& lods) {
    if (!lods.levels.empty())
        std::printf("levels of detail: mean relative error of the picture's pixels, as large as drawn and from afar\n");
    for (const LodFigures& level : lods.levels)
        std::printf("  %-24s %8zu leaves %9zu triangles  %6.1f %%  %6.1f %% from %d times as far\n", level.file.c_str(),
                    level.leaves, level.triangles, 100 * level.image_mre, 100 * level.image_mre_from_afar,
                    level.times_as_far);
    for (const std::filesystem::path& file : lods.files)
        print_file(file);
}

void print_summary(const ShadeOptions& options, const Shading& s, const StageClock& clock) {
    std::printf("%s: %s, %s%s; %s\n", shown_name(s.tree.name).c_str(),
                counted(s.tree.leaves.size(), "leaf", "leaves").c_str(),
                counted(s.patches.patches.size(), "patch", "patches").c_str(),
                s.tree.was_shaded ? " (shaded before: that light is replaced)" : "", s.environment.description.c_str());
    const std::string& instead = s.solution.method_instead;
    std::printf("%s: ", instead.empty() ? std::string(method_name(options.shading.method)).c_str() : instead.c_str());
    if (s.tree.leaves.empty())
        std::printf("no leaves, so no error of them, ");
    if (s.solution.estimated_error)
        std::printf("estimated error %.2g %%%s, ", 100 * *s.solution.estimated_error,
                    asked_text(options.shading).c_str());
    if (!s.solution.residuals.empty())
        std::printf("%s, ", counted(s.solution.residuals.size(), "sweep", "sweeps").c_str());
    std::printf("%s kept for relighting\n", bytes_text(double(s.solution.transport_bytes)).c_str());
    for (const WorkReport::Stage& stage : clock.stages())
        std::printf("  %-12s %10s  (CPU %s)\n", stage.name.c_str(), duration_text(stage.wall_seconds).c_str(),
                    duration_text(stage.cpu_seconds).c_str());
    for (const std::filesystem::path& file : {options.output, options.image, options.report})
        if (!file.empty())
            print_file(file);
}

/// Options about things that this run doesn't make or read.
std::vector<std::string> idle_option_warnings(const CLI::App& app, const ShadeOptions& options) {
    std::vector<std::string> warnings;
    auto warn_if_given = [&](const char* option, const char* why) {
        if (app.get_option(option)->count() > 0)
            warnings.push_back(std::string(option) + " changes nothing here: " + why);
    };
    if (options.image.empty())
        for (const char* option : {"--image-size", "--samples", "--exposure"})
            warn_if_given(option, "no picture is drawn (--image PIC.png draws one)");
    if (!is_environment_image(options.surroundings))
        warn_if_given("--strict", "the environment is no image whose pixels could be refused");
    return warnings;
}

void run_shade(const CLI::App& app, ShadeOptions& options, const CommandContext& context) {
    ShadingRecord record;
    for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->count() > 0; }))
        for (const std::string& value : option->results())
            record.arguments.emplace_back(option->get_name(), value);
    complete_shade_options(options);

    const Stopwatch watch;
    StageClock clock;
    Shading shading;
    shade(options, shading, clock, *context.progress);

    const WritingFiles writing;
    WrittenLods lods;
    if (!options.lods.empty())
        clock.run("levels", [&] {
            lods = write_lods({shading.tree, shading.patches, shading.origins, shading.solution, shading.environment},
                              {.folder = options.lods, .stem = options.tree.stem(), .split_sides = options.split_sides},
                              *context.progress);
        });
    clock.run("write", [&] {
        context.progress->begin("writing", 0);
        if (!options.output.empty())
            write_shaded_tree(options, shading, *context.progress);
        if (shading.picture)
            write_picture(options, *shading.picture);
    });
    record.tree = &shading.tree;
    record.patches = &shading.patches;
    record.environment = &shading.environment;
    record.environment_report = shading.environment_report;
    record.options = options.shading;
    record.solution = &shading.solution;
    record.work.stages = clock.stages();
    for (const std::string& warning : idle_option_warnings(app, options))
        shading.warnings.push_back(warning);
    record.work.warnings = shading.warnings;
    record.cpu_seconds = watch.cpu();
    record.wall_seconds = watch.wall();
    const std::pair<const char*, const std::filesystem::path*> outputs[] = {
        {"tree", &options.output}, {"picture", &options.image}, {"report", &options.report}};
    for (const auto& [what, file] : outputs)
        if (!file->empty())
            record.outputs.emplace_back(what, file->string());
    for (const std::filesystem::path& file : lods.files)
        record.outputs.emplace_back("level of detail", file.string());
    if (!options.report.empty())
        write_json(options.report, shading_report(record));

    context.progress->clear();
    for (const std::vector<std::string>* warnings : {&shading.warnings, &shading.solution.report.warnings})
        for (const std::string& warning : *warnings)
            std::fprintf(stderr, "kokage: warning: %s\n", warning.c_str());
    if (context.quiet)
        return;
    print_summary(options, shading, clock);
    print_lods(lods);
}

} // namespace

Command shade_command(CLI::App& program) {
    const auto options = std::make_shared<ShadeOptions>();
    CLI::App* app = program.add_subcommand("shade", "Shade a tree: the light on both sides of every leaf");
    app->footer("\nExample: kokage shade tree.glb --environment forest.hdr -o lit.glb --image lit.png\nWith none of "
                "-o, --image and --report, all three are written here, called after the tree.");
    add_shade_options(*app, *options);
    return {app, [app, options](const CommandContext& context) { run_shade(*app, *options, context); }};
}

} // namespace kokage

// `kokage bake`: surroundings -> light filtered by ever wider lobes, as a map that renderers look up.
#include "common/environment/lat_long.h"
#include "common/environment/light_description.h"
#include "common/environment/load_environment.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/stopwatch.h"
#include "reflection/maps/bake_sequence.h"
#include "viewer/bake_options.h"
#include "viewer/bake_report.h"
#include "viewer/command.h"
#include "viewer/print_file.h"
#include "viewer/scene/values.h"
#include "viewer/stop_signal.h"
#include "viewer/write_json.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

void print_warnings(const std::vector<std::string>& warnings) {
    for (const std::string& warning : warnings)
        std::fprintf(stderr, "kokage: warning: %s\n", warning.c_str());
}

void print_stages(const WorkReport& work) {
    for (const WorkReport::Stage& stage : work.stages)
        std::printf("  %-34s %10s  (CPU %s)\n", stage.name.c_str(), duration_text(stage.wall_seconds).c_str(),
                    duration_text(stage.cpu_seconds).c_str());
    for (const WorkReport::Skip& skip : work.skips)
        std::printf("  skipped: %s (%s): %s\n", skip.what.c_str(), skip.why.c_str(), skip.saved.c_str());
}

/// "roughness 0.5", "exponent 4.3 (roughness 0.6)".
std::string lobe_text(const Lobe& lobe) {
    char text[80];
    if (lobe.kind == LobeKind::ggx)
        std::snprintf(text, sizeof text, "roughness %.3g", lobe.parameter);
    else
        std::snprintf(text, sizeof text, "exponent %.4g (roughness %.3g)", lobe.parameter,
                      roughness_from_exponent(lobe.parameter));
    return text;
}

void print_lobes(const BakeOptions& options) {
    const std::vector<MapLevel>& levels = options.plan.levels;
    if (options.map.container == MapContainer::voxel_cube) {
        const SmoothnessRange range = smoothness_of(options.map);
        std::printf("  smoothness %.3g to %.3g, %d voxels along an edge\n", range.roughest, range.smoothest,
                    options.plan.size);
    } else if (options.map.container == MapContainer::shells) {
        std::printf("  %s, %s to %s, %d to %d texels along an edge\n",
                    counted(levels.size(), "shell", "shells").c_str(), lobe_text(levels.front().lobe).c_str(),
                    lobe_text(levels.back().lobe).c_str(), levels.front().size, levels.back().size);
    } else {
        for (std::size_t i = 0; i < levels.size(); ++i)
            std::printf("  level %zu: %s, %s along an edge\n", i,
                        levels[i].unfiltered ? "the image itself" : lobe_text(levels[i].lobe).c_str(),
                        counted(std::uint64_t(levels[i].size), "texel", "texels").c_str());
    }
}

void print_map(const BakeOptions& options) {
    if (options.map.container == MapContainer::harmonics) {
        std::printf("spherical harmonics of %s, %s\n", options.quantity.c_str(),
                    counted(std::uint64_t(options.map.harmonics.bands), "band", "bands").c_str());
        return;
    }
    std::printf("%s, %s: %s, %s, by %s\n", std::string(map_container_name(options.map.container)).c_str(),
                std::string(lobe_kind_name(options.map.lobe)).c_str(),
                counted(options.plan.texels, "filtered texel", "filtered texels").c_str(),
                bytes_text(double(options.plan.bytes)).c_str(), options.method.c_str());
    print_lobes(options);
}

BakeRecord begin_record(const BakeOptions& options) {
    BakeRecord record;
    record.options = &options;
    const double rounding = format_rounding(options.map.format);
    if (options.tolerance && *options.tolerance < rounding) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "%s rounds by up to %.2g of a value, more than the tolerance of %.2g; --format "
                      "float does not",
                      options.format.c_str(), rounding, *options.tolerance);
        record.work.warnings.push_back(text);
    }
    return record;
}

/// What a range saved, once it is known what it cost; 0 = that is not known.
void add_saved_by_range(BakeRecord& record, double cpu_seconds_a_map) {
    std::optional<WorkReport::Skip> skip = saved_by_range(record.options->map);
    if (!skip)
        return;
    MapSettings whole = record.options->map;
    whole.smoothness.reset();
    whole.roughness.reset();
    const double part = double(record.options->plan.texels), all = double(plan_map(whole).texels);
    if (part > 0 && all > part && cpu_seconds_a_map > 0)
        skip->saved +=
            ", and about " + duration_text(cpu_seconds_a_map * (all / part - 1)) + " of CPU, at the same cost a texel";
    record.work.skips.push_back(*skip);
}

void finish_record(const BakeOptions& options, BakeRecord& record, const Stopwatch& watch) {
    record.cpu_seconds = watch.cpu();
    record.wall_seconds = watch.wall();
    if (!options.report.empty())
        write_json(options.report, bake_report(record));
}

std::unique_ptr<Baker> baker_for(const BakeOptions& options, const BakedMap& map, const Environment& environment,
                                 WorkReport& work, Progress& progress) {
    if (map.layout().size() == 0)
        return nullptr;
    if (is_same_everywhere(environment))
        return same_everywhere_baker(work);
    return make_baker(map.layout(), environment.remainder.width, environment.remainder.height, options.baker, work,
                      progress);
}

void bake_one(const BakeOptions& options, const CommandContext& context) {
    const Stopwatch watch;
    const std::unique_ptr<BakedMap> map = make_map(options.map);
    BakeRecord record = begin_record(options);
    const Stopwatch loading;
    Environment environment = obtain_environment(options.surroundings, glm::dvec3(0), record.environment_report, false);
    if (!is_environment_image(options.surroundings) && !is_same_everywhere(environment))
        environment.remainder = with_square_pixels(std::move(environment.remainder));
    record.environment = &environment;
    record.work.stages.push_back({"reading the surroundings", loading.cpu(), loading.wall()});
    record.work.warnings.insert(record.work.warnings.end(), record.environment_report.warnings.begin(),
                                record.environment_report.warnings.end());
    if (const auto skip = skipped_by_reduction(record.environment_report, environment))
        record.work.skips.push_back(*skip);
    context.progress->throw_if_stopped();
    const std::unique_ptr<Baker> baker = baker_for(options, *map, environment, record.work, *context.progress);
    const Stopwatch baking;
    map->bake(environment, baker.get(), record.work, *context.progress);
    add_saved_by_range(record, baking.cpu());
    context.progress->throw_if_stopped();

    const WritingFiles writing;
    const Stopwatch saving;
    context.progress->begin("writing", 0);
    map->write(options.output, environment.description, record.work);
    record.work.stages.push_back({"writing", saving.cpu(), saving.wall()});
    finish_record(options, record, watch);
    context.progress->clear();
    print_warnings(record.work.warnings);
    if (context.quiet)
        return;
    std::printf("%s\n", environment.description.c_str());
    print_map(options);
    print_stages(record.work);
    print_file(options.output);
    print_file(options.report);
}

SequenceSettings sequence_settings(const BakeOptions& options) {
    SequenceSettings settings;
    settings.output = options.output;
    settings.baker = options.baker;
    settings.loading.strict = options.surroundings.strict;
    settings.stop_at_broken = options.broken_frames == "stop";
    settings.identity = bake_identity(options).dump();
    Environment lights;
    for (const std::string& light : options.surroundings.lights)
        add_light(lights, light);
    settings.lights = lights.distant_lights;
    return settings;
}

void print_broken_frames(const SequenceResult& result) {
    for (const BrokenFrame& frame : result.first_broken)
        std::fprintf(stderr, "kokage: warning: frame %s is broken and left out: %s\n",
                     std::to_string(frame.number).c_str(), frame.why.c_str());
    if (result.broken > result.first_broken.size())
        std::fprintf(stderr, "kokage: warning: %s more broken frames are left out\n",
                     count_text(result.broken - result.first_broken.size()).c_str());
}

void print_sequence(const SequenceResult& result, const std::string& output) {
    std::printf("%s: %s baked", output.c_str(), counted(result.baked, "frame", "frames").c_str());
    const auto a_frame = [&](double seconds) { return duration_text(seconds / double(result.baked)); };
    if (result.baked > 0)
        std::printf(" in %s, set-up %s; %.3g a second after it; CPU a frame: reading %s, baking %s, writing %s",
                    duration_text(result.wall_seconds).c_str(), duration_text(result.setup_wall_seconds).c_str(),
                    result.frames_per_second(), a_frame(result.reading_cpu_seconds).c_str(),
                    a_frame(result.baking_cpu_seconds).c_str(), a_frame(result.writing_cpu_seconds).c_str());
    if (result.kept > 0)
        std::printf(", %s kept from before", count_text(result.kept).c_str());
    std::printf("%s\n", result.broken > 0 ? (", " + count_text(result.broken) + " broken").c_str() : "");
}

void bake_video(const BakeOptions& options, const CommandContext& context) {
    const Stopwatch watch;
    const std::vector<SequenceImage> images = image_sequence(options.surroundings.environment);
    const std::unique_ptr<BakedMap> map = make_map(options.map);
    BakeRecord record = begin_record(options);
    SequenceResult result;
    try {
        const WritingFiles writing; // a second Ctrl-C waits for the frame's file, too
        result = bake_sequence(images, sequence_settings(options), *map, record.work, *context.progress);
    } catch (const Stopped&) {
        throw StoppedBetweenFiles("finished frames stay in '" +
                                  std::filesystem::path(options.output).parent_path().string() +
                                  "'; the same command goes on");
    }
    record.sequence = &result;
    if (result.baked > 0)
        add_saved_by_range(record, 0); // frames are read and written while others are baked
    finish_record(options, record, watch);
    context.progress->clear();
    print_warnings(record.work.warnings);
    print_broken_frames(result);
    if (context.quiet)
        return;
    print_map(options);
    print_stages(record.work);
    print_sequence(result, options.output);
    print_file(options.report);
}

} // namespace

Command bake_command(CLI::App& program) {
    const auto options = std::make_shared<BakeOptions>();
    CLI::App* app = program.add_subcommand("bake", "Bake a reflection map: surroundings filtered for every roughness");
    app->footer("\nExamples: kokage bake forest.hdr -o forest.ktx2\n          kokage bake forest.hdr --quantity "
                "irradiance -o forest.json\n          kokage bake sky --sun 250,20 "
                "--smoothness 0.3,0.6 -o evening.exr\n          kokage bake 'frames/%04d.hdr' --container cube "
                "--size 64 -o 'maps/%04d.exr'");
    add_bake_options(*app, *options);
    return {app, [options](const CommandContext& context) {
                complete_bake_options(*options);
                if (options->is_sequence)
                    bake_video(*options, context);
                else
                    bake_one(*options, context);
            }};
}

} // namespace kokage

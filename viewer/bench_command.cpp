// `kokage bench`: time against error or size, in tables and plots.
#include "common/services/error.h"
#include "tests/benchmark/foliage_benchmark.h"
#include "tests/benchmark/reflection_benchmark.h"
#include "tests/benchmark/relief_benchmark.h"
#include "tests/benchmark/render_benchmark.h"
#include "tests/benchmark/trees_benchmark.h"
#include "viewer/command.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <stdexcept>

namespace kokage {
namespace {

/// Swallows text, for --quiet.
class NoText : public std::streambuf {
    int overflow(int c) override { return traits_type::not_eof(c); }
};

struct BenchOptions {
    std::string what;
    FoliageBenchmarkOptions foliage; ///< what all have in common is here too
    std::vector<std::string> experiments;
};

int run_benchmarks(const BenchOptions& options, const CommandContext& context, std::ostream& out) {
    const FoliageBenchmarkOptions& common = options.foliage;
    const auto wanted = [&](const char* name) { return options.what == name || options.what == "all"; };
    int failures = 0;
    if (wanted("foliage"))
        failures += run_foliage_benchmark(common, *context.progress, out);
    if (wanted("trees"))
        failures += run_trees_benchmark(
            {.output_folder = common.output_folder, .quick = common.quick, .threads = context.threads},
            *context.progress, out);
    if (wanted("reflection"))
        failures += run_reflection_benchmark({.output_folder = common.output_folder,
                                              .data_folder = common.data_folder,
                                              .quick = common.quick,
                                              .threads = context.threads,
                                              .experiments = options.experiments},
                                             *context.progress, out);
    if (wanted("relief"))
        failures += run_relief_benchmark({.output_folder = common.output_folder,
                                          .data_folder = common.data_folder,
                                          .quick = common.quick,
                                          .threads = context.threads,
                                          .experiments = options.experiments},
                                         *context.progress, out);
    if (wanted("render"))
        failures += run_render_benchmark({.output_folder = common.output_folder,
                                          .data_folder = common.data_folder,
                                          .quick = common.quick,
                                          .threads = context.threads,
                                          .experiments = options.experiments},
                                         *context.progress, out);
    return failures;
}

std::string joined(const std::vector<std::string>& names) {
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text;
}

} // namespace

Command bench_command(CLI::App& program) {
    const auto options = std::make_shared<BenchOptions>();
    FoliageBenchmarkOptions& common = options->foliage;
    CLI::App* app = program.add_subcommand(
        "bench", "Measure: every method's error against time; growing against others; reflection maps; relief; "
                 "pictures");
    app->footer("\nExample: kokage bench foliage --quick -o results");
    app->add_option(
           "WHAT", options->what,
           "foliage (methods of shading: error against time), trees (growing: time and memory against leaves, "
           "beside other generators where they are installed), reflection (reflection maps: the paper's "
           "tables, error against time, beside cmgen where it is installed), relief (rays on height fields: reads, "
           "time, wrong hits, the paper's own experiments), render (pictures: error against time, beside path tracing) "
           "or all")
        ->required();
    app->add_option(
           "-o,--output", common.output_folder,
           "Folder for foliage.json, trees.json, reflection.json, relief.json or render.json, tables (.md), plots and "
           "pictures; made if it is missing")
        ->type_name("FOLDER")
        ->required();
    app->add_flag(
        "--quick", common.quick,
        "foliage: the scenes of 30,000 leaves alone, within two minutes with stored references; trees: two "
        "species; reflection, relief: smaller samples, within two minutes; render: smaller pictures, fewer efforts");
    app->add_option("--data", common.data_folder,
                    "foliage, reflection, relief, render: folder with env (lat-long images), objects and textures")
        ->type_name("FOLDER")
        ->envname("KOKAGE_DATA");
    app->add_option(
           "--experiment", options->experiments,
           "only these, separated by commas (otherwise all): reflection: " + joined(reflection_experiment_names()) +
               "; relief: " + joined(relief_experiment_names()) + "; render: " + joined(render_experiment_names()))
        ->type_name("NAME")
        ->delimiter(',');
    app->add_option("--reference-paths", common.reference_paths,
                    "foliage: paths a leaf side of references that are not stored and must be made")
        ->type_name("N")
        ->check(CLI::PositiveNumber.description(""))
        ->capture_default_str();
    return {app, [options](const CommandContext& context) {
                const std::string& what = options->what;
                if (what != "foliage" && what != "trees" && what != "reflection" && what != "relief" &&
                    what != "render" && what != "all")
                    throw InputError("there is no benchmark '" + what +
                                     "'; there are: foliage, trees, reflection, relief, render, all");
                if (!options->experiments.empty() && what != "reflection" && what != "relief" && what != "render")
                    throw InputError("--experiment: only the benchmarks reflection, relief and render are made of "
                                     "experiments to choose from");
                options->foliage.threads = context.threads;
                NoText nothing;
                std::ostream silent(&nothing);
                if (run_benchmarks(*options, context, context.quiet ? silent : std::cout) != 0)
                    throw std::runtime_error("a measurement failed; the others are in " +
                                             options->foliage.output_folder.string());
            }};
}

} // namespace kokage

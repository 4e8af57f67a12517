// `kokage bench`: time against error or size, in tables and plots.
#include "common/services/error.h"
#include "tests/benchmark/foliage_benchmark.h"
#include "tests/benchmark/trees_benchmark.h"
#include "viewer/command.h"

#include <iostream>
#include <memory>
#include <stdexcept>

namespace kokage {
namespace {

/// Swallows text, for --quiet.
class NoText : public std::streambuf {
    int overflow(int c) override { return traits_type::not_eof(c); }
};

} // namespace

Command bench_command(CLI::App& program) {
    const auto options = std::make_shared<FoliageBenchmarkOptions>();
    CLI::App* app =
        program.add_subcommand("bench", "Measure: every method's error against time; growing against others");
    app->footer("\nExample: kokage bench foliage --quick -o results");
    const auto what = std::make_shared<std::string>();
    app->add_option("WHAT", *what,
                    "foliage (methods of shading: error against time), trees (growing: time and memory against leaves, "
                    "beside other generators where they are installed) or all")
        ->required();
    app->add_option("-o,--output", options->output_folder,
                    "Folder for foliage.json or trees.json, tables (.md) and plots; made if it is missing")
        ->type_name("FOLDER")
        ->required();
    app->add_flag("--quick", options->quick,
                  "foliage: the scenes of 30,000 leaves alone, within two minutes with stored references; trees: two "
                  "species");
    app->add_option("--data", options->data_folder, "foliage: folder with environments (env/*.hdr, *.exr)")
        ->type_name("FOLDER")
        ->envname("KOKAGE_DATA");
    app->add_option("--reference-paths", options->reference_paths,
                    "foliage: paths a leaf side of references that are not stored and must be made")
        ->type_name("N")
        ->check(CLI::PositiveNumber.description(""))
        ->capture_default_str();
    return {app, [options, what](const CommandContext& context) {
                if (*what != "foliage" && *what != "trees" && *what != "all")
                    throw InputError("there is no benchmark '" + *what + "'; there are: foliage, trees, all");
                options->threads = context.threads;
                NoText nothing;
                std::ostream silent(&nothing);
                std::ostream& out = context.quiet ? silent : std::cout;
                int failures = 0;
                if (*what != "trees")
                    failures += run_foliage_benchmark(*options, *context.progress, out);
                if (*what != "foliage")
                    failures += run_trees_benchmark(
                        {.output_folder = options->output_folder, .quick = options->quick, .threads = context.threads},
                        *context.progress, out);
                if (failures != 0)
                    throw std::runtime_error("a measurement failed; the others are in " +
                                             options->output_folder.string());
            }};
}

} // namespace kokage

// `kokage grow`: a tree from a species, as glTF.
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "common/services/output_file.h"
#include "common/services/stopwatch.h"
#include "trees/growth.h"
#include "trees/write_tree.h"
#include "viewer/command.h"
#include "viewer/grow_variants.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/tree_source.h"
#include "viewer/scene/values.h"
#include "viewer/stop_signal.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace kokage {
namespace {

struct GrowOptions {
    TreeSource source;
    std::optional<std::uint64_t> seed;
    std::string seeds;
    std::filesystem::path output;
    bool list = false;
    std::string describe;
};

void print_species_list() {
    std::size_t widest = 0;
    for (const Species& species : all_species())
        widest = std::max(widest, species.latin_name.size());
    for (const Species& species : all_species())
        std::printf("%-8s %-*s  %s\n", species.name.c_str(), int(widest), species.latin_name.c_str(),
                    species.summary.c_str());
}

void print_parameters(const Species& species) {
    std::printf("%s (%s): %s\n", species.name.c_str(), species.latin_name.c_str(), species.summary.c_str());
    for (const std::string& source : species.sources)
        std::printf("  source: %s\n", source.c_str());
    std::string group;
    for (const ParameterDescription& p : parameter_descriptions(species.parameters)) {
        if (p.group != group)
            std::printf("\n%s\n", (group = p.group).c_str());
        std::printf("  %-22s %-10s %s (%s)%s\n", p.name.c_str(), value_text(p).c_str(), p.meaning.c_str(),
                    range_text(p).c_str(), p.source.empty() ? "" : (" [" + p.source + "]").c_str());
    }
}

/// `--describe`: on the terminal, or with -o as a species file to start from.
void describe_species(GrowOptions options, bool quiet) {
    options.source.name = options.describe;
    if (options.seed)
        options.source.settings.push_back("seed=" + std::to_string(*options.seed));
    const Species species = asked_species(options.source);
    if (options.output.empty())
        return print_parameters(species);
    check_output(options.output, "the species file", {".json"});
    check_distinct({options.output, options.source.file()});
    write_file(options.output, species_file_text(species));
    if (!quiet)
        std::printf("%s: all parameters of %s; change them, then: kokage grow %s\n", options.output.c_str(),
                    species.name.c_str(), options.output.c_str());
}

bool sets_seed(const GrowOptions& options) {
    return std::any_of(options.source.settings.begin(), options.source.settings.end(),
                       [](const std::string& setting) { return setting.starts_with("seed="); });
}

void grow_and_write(GrowOptions options, const CommandContext& context) {
    if (!options.source.is_species())
        find_species(options.source.name); // throws, and lists those that there are
    if (options.seed)
        options.source.settings.push_back("seed=" + std::to_string(*options.seed));
    check_tree_source(options.source);
    if (!options.seeds.empty()) {
        if (sets_seed(options))
            throw InputError("a seed and --seeds contradict one another; leave one of them out");
        const SeedRange seeds = seeds_from(options.seeds);
        if (lower_ending(options.output) == ".glb")
            throw InputError("--seeds: many trees need a folder; give -o FOLDER, not '" + options.output.string() +
                             "'");
        return grow_variants(
            options.source, seeds,
            options.output.empty() ? std::filesystem::path(options.source.stem() + "-trees") : options.output, context);
    }
    if (options.output.empty())
        options.output = options.source.stem() + ".glb";
    check_output(options.output, "the tree", {".glb"});

    Stopwatch watch;
    const Tree tree = obtain_tree(options.source, *context.progress);
    const double grown = watch.wall();
    watch.restart();
    context.progress->throw_if_stopped();
    const WritingFiles writing;
    write_tree(options.output, tree, nullptr, {}, *context.progress);
    context.progress->clear();
    if (!context.quiet)
        std::printf("%s: %s, %s; grown in %s, written in %s\n", options.output.c_str(),
                    counted(tree.leaves.size(), "leaf", "leaves").c_str(),
                    counted(tree.skeleton.branches.size(), "branch", "branches").c_str(), duration_text(grown).c_str(),
                    duration_text(watch.wall()).c_str());
}

} // namespace

Command grow_command(CLI::App& program) {
    const auto options = std::make_shared<GrowOptions>();
    CLI::App* app = program.add_subcommand("grow", "Grow a tree and write it as glTF");
    app->footer("\nExample: kokage grow oak --seed 7 --leaves 50000 -o mine.glb\n"
                "         kokage grow birch --seeds 1..20 -o birches\n"
                "         kokage grow --describe beech -o my-beech.json    a species file to change\n"
                "         kokage grow my-beech.json");
    app->add_option("SPECIES", options->source.name, "What to grow: a species (--list names all) or a file of your own")
        ->type_name("NAME|FILE.json")
        ->capture_default_str();
    app->add_option("--seed", options->seed, "Which individual: the same seed gives the same tree (otherwise 1)")
        ->check(whole_number(std::uint64_t(1) << 53)) // as the parameter of that name
        ->type_name("N")
        ->group("Tree");
    app->add_option(
           "--seeds", options->seeds,
           "Many individuals, such as 1..20, into the folder -o with a manifest.json that lists them; a run that "
           "was stopped goes on where it was")
        ->type_name("FIRST..LAST")
        ->group("Tree");
    add_growing_options(*app, options->source);
    app->add_option("-o,--output", options->output,
                    "Where to write it (otherwise SPECIES.glb here; with --seeds a folder, otherwise SPECIES-trees)")
        ->type_name("FILE");
    app->add_flag("--list", options->list, "List the species and do nothing else");
    app->add_option(
           "--describe", options->describe,
           "List a species' parameters with values, ranges, meanings and sources; with -o FILE.json as a species "
           "file of your own to start from")
        ->type_name("SPECIES|FILE");
    return {app, [options](const CommandContext& context) {
                if (options->list)
                    print_species_list();
                else if (!options->describe.empty())
                    describe_species(*options, context.quiet);
                else
                    grow_and_write(*options, context);
            }};
}

} // namespace kokage

// `kokage grow`: a tree from a species, as glTF.
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "common/services/stopwatch.h"
#include "trees/growth.h"
#include "trees/write_tree.h"
#include "viewer/command.h"
#include "viewer/output_check.h"
#include "viewer/stop_signal.h"
#include "viewer/tree_source.h"
#include "viewer/values.h"

#include <cstdio>
#include <filesystem>
#include <memory>

namespace kokage {
namespace {

struct GrowOptions {
    TreeSource source;
    std::optional<std::uint64_t> seed;
    std::filesystem::path output;
    bool list = false;
    std::string describe;
};

void print_species_list() {
    for (const Species& species : all_species())
        std::printf("%-12s %-18s %s\n", species.name.c_str(), species.latin_name.c_str(), species.summary.c_str());
}

void print_parameters(const std::string& name) {
    const Species& species = find_species(name);
    std::printf("%s (%s): %s\n\n%-22s %-12s %-24s %s\n", species.name.c_str(), species.latin_name.c_str(),
                species.summary.c_str(), "parameter", "value", "range", "meaning");
    for (const ParameterDescription& p : parameter_descriptions(species.parameters)) {
        char value[32], range[64];
        if (p.choices.empty()) {
            std::snprintf(value, sizeof value, "%.10g", p.value);
            std::snprintf(range, sizeof range, "%g to %g", p.low, p.high);
        } else {
            std::snprintf(value, sizeof value, "%s", p.choices[std::size_t(p.value - p.low)].c_str());
            std::string names;
            for (const std::string& choice : p.choices)
                names += (names.empty() ? "" : ", ") + choice;
            std::snprintf(range, sizeof range, "%s", names.c_str());
        }
        std::printf("%-22s %-12s %-24s %s%s%s\n", p.name.c_str(), value, range, p.meaning.c_str(),
                    p.unit.empty() ? "" : " Unit: ", p.unit.c_str());
    }
}

void grow_and_write(GrowOptions options, const CommandContext& context) {
    if (!options.source.is_species())
        find_species(options.source.name); // throws, and lists those that there are
    if (options.seed)
        options.source.settings.push_back("seed=" + std::to_string(*options.seed));
    check_tree_source(options.source);
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
    app->footer("\nExample: kokage grow oak --seed 7 --leaves 50000 -o mine.glb");
    app->add_option("SPECIES", options->source.name, "What to grow; --list names all")
        ->type_name("NAME")
        ->capture_default_str();
    app->add_option("--seed", options->seed, "Which individual: the same seed gives the same tree (otherwise 1)")
        ->check(whole_number())
        ->type_name("N")
        ->group("Tree");
    add_growing_options(*app, options->source);
    app->add_option("-o,--output", options->output, "Where to write it (otherwise SPECIES.glb here)")
        ->type_name("TREE.glb");
    app->add_flag("--list", options->list, "List the species and do nothing else");
    app->add_option("--describe", options->describe, "List a species' parameters with values, ranges and meanings")
        ->type_name("SPECIES");
    return {app, [options](const CommandContext& context) {
                if (options->list)
                    print_species_list();
                else if (!options->describe.empty())
                    print_parameters(options->describe);
                else
                    grow_and_write(*options, context);
            }};
}

} // namespace kokage

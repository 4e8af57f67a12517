// `kokage describe`: what was found in a tree.
#include "trees/describe.h"
#include "viewer/command.h"
#include "viewer/tree_source.h"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

struct DescribeOptions {
    TreeSource source;
    bool json = false;
};

void describe_tree(const DescribeOptions& options, const CommandContext& context) {
    check_tree_source(options.source);
    const TreeDescription description = describe(obtain_tree(options.source, *context.progress));
    context.progress->clear();
    // Names in files may hold bytes that are no UTF-8.
    const std::string text =
        options.json ? json_of(description).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"
                     : text_of(description);
    std::fputs(text.c_str(), stdout);
}

} // namespace

Command describe_command(CLI::App& program) {
    const auto options = std::make_shared<DescribeOptions>();
    CLI::App* app =
        program.add_subcommand("describe", "What is found in a tree: foliage, leaves, branching, sizes, colours");
    app->footer("\nExample: kokage describe tree.glb");
    app->add_option("TREE", options->source.name, "A tree's file (.glb, .gltf), or a species or species file (.json) to grow")
        ->type_name("NAME")
        ->required();
    add_growing_options(*app, options->source);
    add_loading_options(*app, options->source);
    app->add_flag("--json", options->json, "As JSON");
    return {app, [options](const CommandContext& context) { describe_tree(*options, context); }};
}

} // namespace kokage

// `kokage describe`: what was found in a tree.
#include "common/scene/image_file.h"
#include "common/services/count_text.h"
#include "common/services/error.h"
#include "trees/describe.h"
#include "viewer/branching_picture.h"
#include "viewer/command.h"
#include "viewer/scene/data_folder.h"
#include "viewer/scene/output_check.h"
#include "viewer/scene/tree_source.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

namespace kokage {
namespace {

struct DescribeOptions {
    TreeSource source;
    std::filesystem::path data; ///< folder that a relative name is also looked for in
    bool json = false;
    std::filesystem::path image;
    int maps = 15;
};

/// Draws and saves; returns lines that say what the picture shows.
std::string draw(const DescribeOptions& options, const Tree& tree, Progress& progress) {
    constexpr int kPanel = 960;
    const BranchingPicture picture = draw_branching(tree, options.maps, kPanel, progress);
    save_image(options.image, picture.image, {.png_encoding = PngEncoding::as_is});
    std::string text = "picture      " + options.image.string() +
                       ": left, leaves in the colour of the branch that they hang on; right, branches by generation (";
    for (const int order : picture.orders)
        text +=
            (order == picture.orders.front() ? "" : ", ") + std::to_string(order) + " " + generation_color_name(order);
    text += "), " + counted(picture.maps, "light map", "light maps") +
            " as balls, the border of each one's leaves as a ring\n";
    return text;
}

void describe_tree(DescribeOptions& options, const CommandContext& context) {
    find_in_data(options.data, {&options.source.name});
    check_tree_source(options.source);
    if (options.maps < 1)
        throw InputError("--maps: " + std::to_string(options.maps) +
                         " light maps are asked for; it must be at least 1");
    if (!options.image.empty()) {
        check_output(options.image, "the picture", {".png"});
        if (!options.source.is_species())
            check_distinct({options.source.name, options.image});
    }
    const Tree tree = obtain_tree(options.source, *context.progress);
    const TreeDescription description = describe(tree);
    const std::string drawn = options.image.empty() ? "" : draw(options, tree, *context.progress);
    context.progress->clear();
    // Names in files may hold bytes that are no UTF-8.
    const std::string text =
        options.json ? json_of(description).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"
                     : text_of(description) + drawn;
    std::fputs(text.c_str(), stdout);
}

} // namespace

Command describe_command(CLI::App& program) {
    const auto options = std::make_shared<DescribeOptions>();
    CLI::App* app =
        program.add_subcommand("describe", "What is found in a tree: foliage, leaves, branching, sizes, colours");
    app->footer("\nExample: kokage describe tree.glb");
    app->add_option("TREE", options->source.name,
                    "A tree's file (.glb, .gltf, .obj), or a species or species file (.json) to grow")
        ->type_name("NAME")
        ->required();
    add_data_option(*app, options->data, "TREE is");
    add_growing_options(*app, options->source);
    add_loading_options(*app, options->source);
    app->add_flag("--json", options->json, "As JSON");
    app->add_option("--image", options->image,
                    "Draw what was found: leaves by the branch that they hang on, branches by generation, light maps")
        ->type_name("FILE.png");
    app->add_option("--maps", options->maps, "Light maps that --image shows: as many as `shade --method paper` has")
        ->type_name("N")
        ->capture_default_str();
    return {app, [options](const CommandContext& context) { describe_tree(*options, context); }};
}

} // namespace kokage

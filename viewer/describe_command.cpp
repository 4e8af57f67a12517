// `kokage describe`: what was found in a tree.
#include "trees/patches.h"
#include "viewer/command.h"
#include "viewer/tree_source.h"
#include "viewer/values.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

namespace kokage {
namespace {

std::string color_text(const glm::vec3& c) {
    char text[64];
    std::snprintf(text, sizeof text, "%.3f, %.3f, %.3f", double(c.r), double(c.g), double(c.b));
    return text;
}

std::string length_text(double metres) {
    char text[32];
    std::snprintf(text, sizeof text, metres < 0.995 ? "%.3g cm" : "%.3g m", metres < 0.995 ? 100 * metres : metres);
    return text;
}

std::string area_text(double square_metres) {
    char text[32];
    if (square_metres < 0.1)
        std::snprintf(text, sizeof text, "%.3g cm2", 1e4 * square_metres);
    else
        std::snprintf(text, sizeof text, "%.4g m2", square_metres);
    return text;
}

void print_size(const Tree& tree, const PatchScene& scene) {
    const Bounds box = bounds_of(scene);
    const glm::vec3 size = box.high - box.low;
    std::printf("size         %s high, %s x %s wide; lowest point at height %.4g m\n",
                length_text(double(size.y)).c_str(), length_text(double(size.x)).c_str(),
                length_text(double(size.z)).c_str(), double(box.low.y) + tree.origin.y);
}

void print_leaves(const Tree& tree, const PatchScene& scene) {
    const std::vector<double> areas = solid_areas(scene);
    std::vector<double> leaf_areas(tree.leaves.size(), 0.0);
    double leaf_total = 0, bark_total = 0;
    for (std::size_t p = 0; p < areas.size(); ++p) {
        if (scene.patches[p].kind == PatchKind::leaf) {
            leaf_areas[scene.patches[p].leaf] += areas[p];
            leaf_total += areas[p];
        } else {
            bark_total += areas[p];
        }
    }
    std::printf("leaves       %s", count_text(tree.leaves.size()).c_str());
    if (!leaf_areas.empty()) {
        std::sort(leaf_areas.begin(), leaf_areas.end());
        std::printf(", %s together (one side), median %s, largest %s", area_text(leaf_total).c_str(),
                    area_text(leaf_areas[leaf_areas.size() / 2]).c_str(), area_text(leaf_areas.back()).c_str());
    }
    std::printf("\nbark         %s patches, %s\n", count_text(tree.bark_patch_count).c_str(),
                area_text(bark_total).c_str());
}

void print_branching(const Tree& tree) {
    std::map<int, std::size_t> branches_of_order, leaves_of_order;
    for (const Branch& branch : tree.skeleton.branches)
        ++branches_of_order[branch.order];
    std::size_t lost = 0;
    for (const Leaf& leaf : tree.leaves) {
        if (leaf.branch < 0)
            ++lost;
        else
            ++leaves_of_order[tree.skeleton.branches[std::size_t(leaf.branch)].order];
    }
    std::printf("branching    %s, %s branches\n", tree.branching_known ? "known" : "inferred from bark and leaves",
                count_text(tree.skeleton.branches.size()).c_str());
    for (const auto& [order, count] : branches_of_order)
        std::printf("  order %-4d %s branches, %s leaves\n", order, count_text(count).c_str(),
                    count_text(leaves_of_order[order]).c_str());
    if (lost > 0)
        std::printf("  %s leaves belong to no branch\n", count_text(lost).c_str());
}

void print_materials(const Tree& tree) {
    for (const TreePart& part : tree.parts) {
        const TreeMaterial& material = tree.materials[part.material];
        const bool leaf = part.kind == TreePartKind::foliage;
        const Optics optics = optics_of(material, part.kind, mean_base_color(tree, part.material, part.kind));
        std::printf("%-12s '%s': %s triangles%s%s; reflectance %s", leaf ? "foliage" : "bark", material.name.c_str(),
                    count_text(part.triangles.size()).c_str(), material.base_color_texture ? ", textured" : "",
                    material.alpha_texture ? ", alpha mask" : "", color_text(optics.reflectance).c_str());
        if (leaf)
            std::printf("; transmittance %s%s", color_text(optics.transmittance).c_str(),
                        material.diffuse_transmission < 0 ? " (guessed)" : "");
        std::printf("\n");
    }
}

void describe(const TreeSource& source, const CommandContext& context) {
    check_tree_source(source);
    const Tree tree = obtain_tree(source, *context.progress);
    const PatchScene scene = make_patches(tree);
    context.progress->clear();
    std::printf("tree         %s (%s)\n", tree.name.c_str(), tree.source.c_str());
    print_size(tree, scene);
    print_leaves(tree, scene);
    print_branching(tree);
    print_materials(tree);
    for (const std::string& note : tree.notes)
        std::printf("note         %s\n", note.c_str());
}

} // namespace

Command describe_command(CLI::App& program) {
    const auto source = std::make_shared<TreeSource>();
    CLI::App* app =
        program.add_subcommand("describe", "What is found in a tree: foliage, leaves, branching, sizes, colours");
    app->footer("\nExample: kokage describe tree.glb");
    app->add_option("TREE", source->name, "A tree's file (.glb, .gltf), or a species to grow")
        ->type_name("NAME")
        ->required();
    add_growing_options(*app, *source);
    add_loading_options(*app, *source);
    return {app, [source](const CommandContext& context) { describe(*source, context); }};
}

} // namespace kokage

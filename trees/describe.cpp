#include "trees/describe.h"

#include "common/services/count_text.h"
#include "common/services/named_file.h"
#include "trees/find_branching.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

namespace kokage {
namespace {

std::string formatted(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

std::string color_text(const glm::vec3& c) {
    return formatted("%.3f, ", double(c.r)) + formatted("%.3f, ", double(c.g)) + formatted("%.3f", double(c.b));
}

void measure(const Tree& tree, TreeDescription& d) {
    const PatchScene scene = make_patches(tree);
    const Bounds box = bounds_of(scene);
    d.low = glm::dvec3(box.low) + tree.origin;
    d.high = glm::dvec3(box.high) + tree.origin;
    d.triangles = scene.triangles.size();
    const std::vector<double> areas = solid_areas(scene);
    std::vector<double> leaf_areas(tree.leaves.size(), 0.0);
    for (std::size_t p = 0; p < areas.size(); ++p) {
        if (scene.patches[p].kind == PatchKind::leaf) {
            leaf_areas[scene.patches[p].leaf] += areas[p];
            d.leaf_area_m2 += areas[p];
        } else {
            d.bark_area_m2 += areas[p];
        }
    }
    if (leaf_areas.empty())
        return;
    std::sort(leaf_areas.begin(), leaf_areas.end());
    d.smallest_leaf_m2 = leaf_areas.front();
    d.median_leaf_m2 = leaf_areas[leaf_areas.size() / 2];
    d.largest_leaf_m2 = leaf_areas.back();
}

/// The area below the leaves' centres, as foresters measure crowns.
double crown_projection(const Tree& tree) {
    constexpr std::size_t kSectors = 32;
    glm::dvec2 middle(0.0);
    for (const Leaf& leaf : tree.leaves)
        middle += glm::dvec2(leaf.centre.x, leaf.centre.z) / double(tree.leaves.size());
    std::array<double, kSectors> reach{};
    for (const Leaf& leaf : tree.leaves) {
        const glm::dvec2 way = glm::dvec2(leaf.centre.x, leaf.centre.z) - middle;
        const double turn = (std::atan2(way.y, way.x) + kPiDouble) / (2 * kPiDouble);
        double& farthest = reach[std::min(std::size_t(turn * double(kSectors)), kSectors - 1)];
        farthest = std::max(farthest, glm::length(way));
    }
    double area = 0;
    for (const double r : reach)
        area += r * r * kPiDouble / double(kSectors);
    return area;
}

void count_orders(const Tree& tree, TreeDescription& d) {
    for (const Branch& branch : tree.skeleton.branches) {
        TreeDescription::Order& order = d.orders[branch.order];
        ++order.branches;
        for (std::size_t n = 1; n < branch.nodes.size(); ++n)
            order.mean_length_m += double(glm::distance(branch.nodes[n - 1].position, branch.nodes[n].position));
        float thickest = 0;
        for (const Branch::Node& node : branch.nodes)
            thickest = std::max(thickest, node.radius_m);
        order.mean_radius_m += double(thickest);
    }
    for (auto& [number, order] : d.orders) {
        order.mean_length_m /= double(order.branches);
        order.mean_radius_m /= double(order.branches);
    }
    std::set<std::int32_t> bearing;
    for (const Leaf& leaf : tree.leaves) {
        if (leaf.branch < 0 || std::size_t(leaf.branch) >= tree.skeleton.branches.size()) {
            ++d.leaves_without_branch;
            continue;
        }
        TreeDescription::Order& order = d.orders[tree.skeleton.branches[std::size_t(leaf.branch)].order];
        ++order.leaves;
        if (bearing.insert(leaf.branch).second)
            ++order.bearing;
    }
}

nlohmann::json vector_json(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

/// What a person should look at twice: a file in other units, or with another axis up.
void doubt_size_and_axis(const Tree& tree, TreeDescription& d) {
    const double height = d.high.y - d.low.y;
    if (d.triangles > 0 && (height > 60 || height < 0.02))
        d.notes.push_back("it is " + length_text(height) +
                          " high, if the file's unit is the metre; --scale sets another");
    const auto trunk = std::find_if(tree.skeleton.branches.begin(), tree.skeleton.branches.end(),
                                    [](const Branch& branch) { return branch.parent < 0; });
    if (tree.branching_known || trunk == tree.skeleton.branches.end() || trunk->nodes.size() < 2)
        return;
    const glm::vec3 way = trunk->nodes.back().position - trunk->nodes.front().position;
    const float length = glm::length(way);
    if (length > 0 && std::abs(way.y) < 0.3f * length)
        d.notes.push_back(
            std::string("its trunk lies along the ") + (std::abs(way.x) > std::abs(way.z) ? "x" : "z") +
            " axis, while +Y is up" +
            (way.z > std::abs(way.x) ? ": --up z sets it upright" : "; turn it in the program that it comes from"));
}

/// Shortest decimal that reads back as the same float: 0.1, not 0.10000000149.
nlohmann::json color_json(const glm::vec3& c) {
    const auto number = [](float value) { return std::stod(formatted("%.6g", double(value))); };
    return {number(c.r), number(c.g), number(c.b)};
}

} // namespace

TreeDescription describe(const Tree& tree) {
    TreeDescription d;
    d.name = tree.name;
    d.source = tree.source;
    d.crown_radius_m = double(crown_radius(tree));
    d.leaves = tree.leaves.size();
    d.bark_patches = tree.bark_patch_count;
    d.branching_known = tree.branching_known;
    d.was_shaded = tree.was_shaded;
    d.notes = tree.notes;
    measure(tree, d);
    d.crown_projection_m2 = crown_projection(tree);
    count_orders(tree, d);
    doubt_size_and_axis(tree, d);
    for (const TreePart& part : tree.parts) {
        const TreeMaterial& material = tree.materials[part.material];
        TreeDescription::Surface surface;
        surface.material = material.name;
        surface.kind = part.kind;
        surface.triangles = part.triangles.size();
        surface.textured = material.base_color_texture != nullptr;
        surface.masked = material.alpha_texture != nullptr;
        surface.optics = optics_of(material, part.kind, mean_base_color(tree, part.material, part.kind));
        surface.transmittance_guessed = part.kind == TreePartKind::foliage && material.diffuse_transmission < 0;
        d.surfaces.push_back(std::move(surface));
    }
    return d;
}

std::string text_of(const TreeDescription& d) {
    const glm::dvec3 size = d.high - d.low;
    std::string text = "tree         " + shown_name(d.name) + " (" + without_controls(d.source) + ")\n";
    text += "size         " + length_text(size.y) + " high, " + length_text(size.x) + " x " + length_text(size.z) +
            " wide; crown radius " + length_text(d.crown_radius_m) + "; lowest point at height " +
            (d.low.y < 0 ? "-" : "") + length_text(std::abs(d.low.y)) + "\n";
    text += "leaves       " + count_text(d.leaves);
    if (d.leaves > 0)
        text += ", " + area_text(d.leaf_area_m2) + " together (one side), median " + area_text(d.median_leaf_m2) +
                ", smallest " + area_text(d.smallest_leaf_m2) + ", largest " + area_text(d.largest_leaf_m2);
    if (d.crown_projection_m2 > 0)
        text += "; leaf area index " + formatted("%.3g", d.leaf_area_m2 / d.crown_projection_m2);
    text += "\nbark         " + counted(d.bark_patches, "patch", "patches") + ", " + area_text(d.bark_area_m2) + "\n";
    std::size_t branches = 0;
    for (const auto& [number, order] : d.orders)
        branches += order.branches;
    text += std::string("branching    ") + (d.branching_known ? "known" : "inferred from bark and leaves") + ", " +
            counted(branches, "branch", "branches") + "\n";
    for (const auto& [number, order] : d.orders) {
        char label[24];
        std::snprintf(label, sizeof label, "  order %-4d ", number);
        text += label + counted(order.branches, "branch", "branches") + ", " + counted(order.leaves, "leaf", "leaves");
        if (order.bearing < order.branches && order.leaves > 0)
            text += " on " + count_text(order.bearing) + " of them";
        if (order.mean_length_m > 0)
            text += (order.branches > 1 ? "; on average " : "; ") + length_text(order.mean_length_m) + " long";
        if (order.mean_radius_m > 0)
            text += ", radius " + length_text(order.mean_radius_m);
        else if (order.mean_length_m > 0)
            text += ", imagined";
        text += "\n";
    }
    if (d.leaves_without_branch > 0)
        text += "  of no branch: " + counted(d.leaves_without_branch, "leaf", "leaves") + "\n";
    for (const TreeDescription::Surface& s : d.surfaces) {
        if (s.triangles == 0) // the leaves of a bare tree
            continue;
        const bool leaf = s.kind == TreePartKind::foliage;
        text += std::string(leaf ? "foliage" : "bark   ") + "      '" + shown_name(s.material) +
                "': " + counted(s.triangles, "triangle", "triangles") + (s.textured ? ", textured" : "") +
                (s.masked ? ", alpha mask" : "") + "; reflectance " + color_text(s.optics.reflectance);
        if (leaf)
            text +=
                "; transmittance " + color_text(s.optics.transmittance) + (s.transmittance_guessed ? " (guessed)" : "");
        text += "\n";
    }
    if (d.was_shaded)
        text += "light        shaded already: the file holds the light on every leaf\n";
    for (const std::string& note : d.notes)
        text += "note         " + without_controls(note) + "\n";
    return text;
}

nlohmann::json json_of(const TreeDescription& d) {
    nlohmann::json json = {{"name", d.name},
                           {"source", d.source},
                           {"bounds", {{"low", vector_json(d.low)}, {"high", vector_json(d.high)}}},
                           {"height_m", d.high.y - d.low.y},
                           {"crown_radius_m", d.crown_radius_m},
                           {"crown_projection_m2", d.crown_projection_m2},
                           {"triangles", d.triangles},
                           {"leaves",
                            {{"count", d.leaves},
                             {"area_m2", d.leaf_area_m2},
                             {"smallest_m2", d.smallest_leaf_m2},
                             {"median_m2", d.median_leaf_m2},
                             {"largest_m2", d.largest_leaf_m2},
                             {"without_branch", d.leaves_without_branch}}},
                           {"bark", {{"patches", d.bark_patches}, {"area_m2", d.bark_area_m2}}},
                           {"branching", {{"known", d.branching_known}, {"orders", nlohmann::json::array()}}},
                           {"shaded", d.was_shaded},
                           {"surfaces", nlohmann::json::array()},
                           {"notes", d.notes}};
    for (const auto& [number, order] : d.orders)
        json["branching"]["orders"].push_back({{"order", number},
                                               {"branches", order.branches},
                                               {"bearing", order.bearing},
                                               {"leaves", order.leaves},
                                               {"mean_length_m", order.mean_length_m},
                                               {"mean_radius_m", order.mean_radius_m}});
    for (const TreeDescription::Surface& s : d.surfaces) {
        nlohmann::json surface = {{"material", s.material},
                                  {"kind", s.kind == TreePartKind::foliage ? "foliage" : "bark"},
                                  {"triangles", s.triangles},
                                  {"textured", s.textured},
                                  {"alpha_mask", s.masked},
                                  {"reflectance", color_json(s.optics.reflectance)},
                                  {"transmittance", color_json(s.optics.transmittance)},
                                  {"transmittance_guessed", s.transmittance_guessed}};
        json["surfaces"].push_back(std::move(surface));
    }
    return json;
}

} // namespace kokage

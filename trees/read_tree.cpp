#include "trees/read_tree.h"

#include "common/obj/obj_scene.h"
#include "common/services/error.h"
#include "common/services/named_file.h"
#include "trees/find_branching.h"
#include "trees/foreign_tree.h"
#include "trees/tree_extras.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tiny_gltf.h>

namespace kokage {

namespace {

void scale_tree(Tree& tree, double scale) {
    const auto scaled = [scale](const glm::vec3& v) { return glm::vec3(glm::dvec3(v) * scale); };
    tree.origin *= scale;
    for (Branch& branch : tree.skeleton.branches)
        for (Branch::Node& node : branch.nodes)
            node = {scaled(node.position), float(double(node.radius_m) * scale)};
    for (TreePart& part : tree.parts)
        for (glm::vec3& position : part.positions)
            position = scaled(position);
    for (Leaf& leaf : tree.leaves)
        leaf.centre = scaled(leaf.centre);
    for (TreeMaterial& material : tree.materials) {
        material.height_depth_m = float(double(material.height_depth_m) * scale);
        material.height_tile_m = float(double(material.height_tile_m) * scale);
    }
}

/// Whether a mesh carries the attributes that write_tree() gives shaded trees (another program may have kept them).
bool holds_light(const GltfDocument& document) {
    for (const tinygltf::Mesh& mesh : document.model().meshes)
        for (const tinygltf::Primitive& primitive : mesh.primitives)
            if (primitive.attributes.contains("_RADIANCE_FRONT") || primitive.attributes.contains("_RADIANCE"))
                return true;
    return false;
}

/// Files of trees that other programs know.
void refuse_other_formats(const std::filesystem::path& path, const std::string& extension) {
    constexpr std::array<std::string_view, 22> known = {
        ".fbx", ".blend", ".3ds", ".max", ".dae", ".stl", ".ply", ".usd", ".usdc", ".usda", ".usdz",
        ".abc", ".c4d",   ".mb",  ".ma",  ".spm", ".srt", ".st",  ".xml", ".x3d",  ".lwo",  ".zip"};
    if (std::find(known.begin(), known.end(), extension) != known.end())
        throw InputError(path.string() + ": files that end in " + extension +
                         " can't be read; export the tree as .glb, .gltf or .obj");
}

} // namespace

Tree read_tree(const std::filesystem::path& path, const ReadOptions& options, Progress& progress) {
    if (!(options.scale > 0) || !std::isfinite(options.scale))
        throw InputError("the scale of a tree is " + std::to_string(options.scale) + "; it must be above 0");
    if (!(options.leaf_size >= 0) || !std::isfinite(options.leaf_size))
        throw InputError("the leaf size is " + std::to_string(options.leaf_size) +
                         " m; it must be 0 (found by itself) or above");
    const std::string extension = lower_ending(path);
    refuse_other_formats(path, extension);
    if (extension == ".obj")
        return tree_from_scene(read_obj_scene(path, progress), path.string(), options, progress);
    const GltfDocument document = GltfDocument::read(path, progress);
    const bool shaded = holds_light(document);
    std::string why;
    if (options.foliage_materials.empty() && options.leaf_size == 0 && !options.z_is_up) {
        if (std::optional<OwnTree> own = read_own_tree(document, why, progress)) {
            if (options.scale != 1)
                scale_tree(own->tree, options.scale);
            own->tree.was_shaded = shaded;
            return std::move(own->tree);
        }
    }
    Tree tree = read_foreign_tree(document, options, progress);
    tree.was_shaded = shaded;
    if (!why.empty())
        tree.notes.insert(tree.notes.begin(), why + ": leaves and branching were found anew");
    return tree;
}

} // namespace kokage

#pragma once
// What `extras.kokage` of a tree's glTF holds. Private to trees.
//
//   version           1
//   name, source, notes, branching_known
//   origin            [x, y, z] in double precision; the root node's translation as well
//   skeleton          branches: count; parent, order, node_count: accessors, one unsigned integer a branch (2^32 - 1 =
//   no parent);
//                     nodes: accessor VEC4, position and radius
//   leaves            count; centre: accessor VEC3; branch: accessor (2^32 - 1 = unknown)
//   bark_patches      count
//   heights           [{width, height, values: accessor}], images of bark's heights, which materials share
//   materials         [{double_sided, has_color, diffuse_transmission: [factor, r, g, b],
//                     relief: {heights: number of the image, depth, tile}}], as long as Tree::materials
//   parts             [{kind, material, mesh, primitive, vertices, triangles, duplicates; triangle_patch, duplicate_of:
//                     accessors}]
//                     the vertices beyond `vertices` repeat those that duplicate_of names, where a patch's attributes
//                     need their own
//   light_maps        count; position, radius, generation, bands, coefficients: accessors
//   shaded            {scale}: there if the file is shaded
//   fingerprint       of all arrays above and the positions: a file that was edited by another program no longer has
//   it, and is then
//                     read like anybody's
#include "common/gltf/gltf_scene.h"
#include "common/gltf/gltf_writer.h"
#include "trees/write_tree.h"

#include <optional>

namespace kokage {

/// Where a part went in the file.
struct PartPlace {
    int mesh = -1, primitive = -1;           ///< -1: a part without triangles
    std::vector<std::uint32_t> duplicate_of; ///< vertices appended after the part's own
};

nlohmann::json write_extras(GltfWriter& writer, const Tree& tree, const std::vector<PartPlace>& places,
                            const ShadedAttributes* shaded, float scale);

/// A file of ours, taken apart.
struct OwnTree {
    Tree tree;
    std::vector<PartPlace> places; ///< of tree.parts
    bool shaded = false;
    float scale = 0;
    std::vector<LightMap> light_maps;
    std::vector<std::map<std::string, int>> attributes; ///< custom attributes' accessors, of tree.parts
};

/// Empty if the file is not ours or was edited since; `why` then says so for a file that was ours. Throws InputError
/// for images that can't be decoded.
std::optional<OwnTree> read_own_tree(const GltfDocument& document, std::string& why, Progress& progress);

} // namespace kokage

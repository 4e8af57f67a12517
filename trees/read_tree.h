#pragma once
// Trees from glTF and OBJ files: our own, which reload exactly, and anybody's, in which foliage, leaves and branching
// are found.
#include "common/services/progress.h"
#include "trees/tree.h"

#include <filesystem>

namespace kokage {

struct ReadOptions {
    /// Names of materials (or of meshes, or nodes) that are foliage, any case; everything else is then bark. Empty:
    /// found by itself.
    std::vector<std::string> foliage_materials = {};
    /// Metres: larger connected foliage is cut into patches of about this radius; 0 = 5 % of the crown's radius.
    float leaf_size = 0;
    /// The file's unit in metres: positions are multiplied by it.
    double scale = 1;
    /// The file's +Z is up, as that of some OBJ files is, rather than +Y: the tree is turned about X.
    bool z_is_up = false;
    /// Reads TreeMaterial::normal_texture of a glTF's opaque materials.
    bool normal_textures = false;
};

/// Reads a .glb, .gltf or .obj. A file written by write_tree() gives back the same tree, bit for bit (with `options` at
/// their defaults); in any other, as Tree::notes tells:
/// - foliage is what the user says, else what has alpha mask or blend or transmission, else what is named so, else what
/// is green;
/// - a leaf is what is connected, split where normals turn by more than 30 degrees or it is larger than 5 % of the
/// crown's radius;
/// - branching is inferred from the bark's shape and from clusters of leaves.
/// Throws InputError with one line that begins with the path.
Tree read_tree(const std::filesystem::path& path, const ReadOptions& options = {},
               Progress& progress = silent_progress());

} // namespace kokage

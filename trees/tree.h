#pragma once
// A tree as grown or loaded: its branching, its bark and its leaves. Everything downstream starts here.
#include "common/scene/alpha_mask.h"
#include "common/scene/image.h"
#include "common/types.h"

#include <memory>
#include <string>
#include <vector>

namespace kokage {

/// A run of wood from where it leaves its parent to its tip.
struct Branch {
    struct Node {
        glm::vec3 position;
        float radius_m;
    };
    std::int32_t parent = -1; ///< index of the parent branch; -1 for the trunk (or for each stem of a bush)
    int order = 0;            ///< generation: the trunk is order 0, a branch on a branch of order k has order k+1
    std::vector<Node> nodes;  ///< at least 1; nodes[0] is the branching point, where it leaves its parent
};

/// Parents come before their children.
struct Skeleton {
    std::vector<Branch> branches;
};

/// How a surface looks (glTF's metallic-roughness without what foliage doesn't need).
struct TreeMaterial {
    std::string name;
    glm::vec3 base_color{1.f};                       ///< linear
    std::shared_ptr<const Image> base_color_texture; ///< linear RGB, 3 channels; null = none
    std::shared_ptr<const Image> alpha_texture;      ///< 1 channel; null = solid
    float alpha_cutoff = 0.5f;
    TextureWrap wrap_u = TextureWrap::repeat, wrap_v = TextureWrap::repeat;
    bool double_sided = true;
    float roughness = 1.f;
    float diffuse_transmission = -1.f; ///< KHR_materials_diffuse_transmission factor; < 0 = not given
    glm::vec3 diffuse_transmission_color{1.f};
    /// Bark's relief: 1 channel, 0 (the bottom of the deepest fissure) .. 1, in the base colour's texture coordinates;
    /// null = even.
    std::shared_ptr<const Image> height_texture;
    float height_depth_m = 0; ///< how much higher 1 is than 0 ...
    float height_tile_m = 0;  ///< ... where a tile of texture is this wide; 0 = everywhere
    /// Bark's normals in the tangent frame, 0..1 for -1..1, green towards smaller v, in the base colour's texture
    /// coordinates; null = none, or not asked for. Not written to files.
    std::shared_ptr<const Image> normal_texture;
    float normal_scale = 1; ///< times their slopes
};

enum class TreePartKind { foliage, bark };

/// One triangle mesh with one material.
struct TreePart {
    TreePartKind kind = TreePartKind::bark;
    std::uint32_t material = 0;
    std::vector<glm::vec3> positions; ///< relative to Tree::origin
    std::vector<glm::vec3> normals;   ///< unit; as long as positions
    std::vector<glm::vec2> uvs;       ///< as long as positions (KHR_texture_transform applied), or empty
    std::vector<glm::uvec3> triangles;
    /// Foliage: the leaf of each triangle, numbered from 0 over the whole tree; a leaf's triangles are consecutive in
    /// one part. Bark: the bark patch of each triangle, numbered from 0 over the whole tree, consecutive likewise (a
    /// patch is a piece of bark about as long as it is thick around, small enough to carry one radiance).
    std::vector<std::uint32_t> triangle_patch;
};

struct Leaf {
    glm::vec3 centre{0.f};    ///< area centroid, relative to Tree::origin
    std::int32_t branch = -1; ///< the branch that bears it; -1 = unknown
};

struct Tree {
    std::string name;       ///< "oak", or a file's stem
    std::string source;     ///< "grown: oak, seed 1", or the file's path
    glm::dvec3 origin{0.0}; ///< added to every position: files far from the origin keep their precision
    Skeleton skeleton;
    std::vector<TreeMaterial> materials;
    std::vector<TreePart> parts;
    std::vector<Leaf> leaves;
    std::uint32_t bark_patch_count = 0;
    bool branching_known = true;    ///< false: inferred from bark and leaf clusters
    bool was_shaded = false;        ///< the file that it was read from holds light of an earlier shading
    std::vector<std::string> notes; ///< what was guessed or substituted, for reports
};

} // namespace kokage

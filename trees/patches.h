#pragma once
// Tree -> PatchScene: what light transport sees of a tree.
#include "common/scene/patch_scene.h"
#include "trees/tree.h"

#include <optional>
#include <vector>

namespace kokage {

struct PatchOptions {
    std::optional<Optics> leaf_optics;    ///< overrides every foliage material's rho and tau
    std::optional<glm::vec3> bark_albedo; ///< overrides every bark material's albedo
    std::optional<Ground> ground;         ///< its height is relative to Tree::origin, as all positions are
    int leaf_subdivisions = 0; ///< each leaf becomes up to 4^n patches, for errors below one radiance a leaf side; 0..6
};

/// What a patch scene's vertices and triangles were in the tree: for pictures and files.
struct PatchOrigins {
    std::vector<std::uint32_t> triangle_part; ///< index in Tree::parts, per scene triangle
    std::vector<glm::vec3> normals;           ///< per scene position
};

/// rho = (1-f) base colour, tau = f transmission colour; without KHR_materials_diffuse_transmission tau = 0.8 rho,
/// scaled to rho + tau <= 0.95. Texture means are weighted by alpha. Patches: leaves first, in leaf order,
/// then bark patches in order. Positions are those of the tree's parts one after the other (part 0's first), then those
/// that subdivision adds; relative to Tree::origin. uvs are there if any part has them. Throws InputError if the tree's
/// indices contradict one another.
PatchScene make_patches(const Tree& tree, const PatchOptions& options = {}, PatchOrigins* origins = nullptr);

/// The base colour (factor times texture) of a material's surface in this tree: the mean, weighted by area and alpha,
/// over the texture coordinates that its triangles use (so that a palette texture gives the colour that is seen, not
/// the palette's mean).
glm::vec3 mean_base_color(const Tree& tree, std::uint32_t material, TreePartKind kind);

/// The optics that a material with this mean base colour has, as make_patches derives them.
Optics optics_of(const TreeMaterial& material, TreePartKind kind, const glm::vec3& mean_base_color);
/// The same with the mean over the whole texture.
Optics optics_of(const TreeMaterial& material, TreePartKind kind);

} // namespace kokage

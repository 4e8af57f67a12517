#pragma once
// Tree -> PatchScene: what light transport sees of a tree.
#include "common/scene/patch_scene.h"
#include "trees/tree.h"

#include <optional>

namespace kokage {

struct PatchOptions {
    std::optional<Optics> leaf_optics;       ///< overrides every foliage material's rho and tau
    std::optional<glm::vec3> bark_albedo;    ///< overrides every bark material's albedo
    std::optional<Ground> ground;
    int leaf_subdivisions = 0;               ///< each leaf becomes up to 4^n patches, for errors below one radiance a leaf side
};

/// rho = (1-f) base colour, tau = f transmission colour; without KHR_materials_diffuse_transmission tau = 0.8 rho, scaled to
/// rho + tau <= 0.95 (DESIGN 4). Texture means are weighted by alpha. Patches: leaves first, in leaf order, then bark patches in order.
PatchScene make_patches(const Tree& tree, const PatchOptions& options = {});

/// The optics of one material as make_patches derives it.
Optics optics_of(const TreeMaterial& material, TreePartKind kind);

} // namespace kokage

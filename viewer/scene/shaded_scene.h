#pragma once
// Joins a tree, its patches and its solved light into what the renderer draws.
#include "foliage/solution.h"
#include "reflection/picture.h"
#include "trees/patches.h"

namespace kokage {

/// Of a part of the tree; `mean`: mean_base_color of its material.
SurfaceLook look_of(const Tree& tree, const TreePart& part, const glm::vec3& mean);

/// `patches` must outlive the result.
ShadedScene shaded_scene(const Tree& tree, const PatchScene& patches, const PatchOrigins& origins,
                         const Solution& solution);

} // namespace kokage

#pragma once
// Joins a tree, its patches and its solved light into what the renderer draws.
#include "foliage/solution.h"
#include "reflection/picture.h"
#include "trees/patches.h"

namespace kokage {

/// `patches` must outlive the result.
ShadedScene shaded_scene(const Tree& tree, const PatchScene& patches, const PatchOrigins& origins,
                         const Solution& solution);

} // namespace kokage

#pragma once
// Light-environment maps of a solved scene for those who light single points from them: bark's gloss in pictures.
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "common/trace/ray_queries.h"
#include "foliage/solution.h"
#include "trees/tree.h"

namespace kokage {

struct PatchLightMapOptions {
    int maps_a_stem = 15; ///< places to pick for each stem of the tree, as [F] has for one (measured: 100 no better)
    int bands = 7;
    std::uint64_t seed = 1;
};

/// All light but the split-off lights' own that arrives at branching points: the sky as seen past the tree, and what
/// patches and ground send under `radiance`, lights in it. `readers`: per patch, 1 where it will read maps; what none
/// of them reads is not captured, and if there are none, nothing is. Reports the maps that were captured, and what was
/// left out. Throws Stopped.
LightMapsOfPatches make_patch_light_maps(const RayQueries& queries, const Tree& tree,
                                         const std::vector<std::uint8_t>& readers, const Environment& environment,
                                         const SideRadiance& radiance, const PatchLightMapOptions& options,
                                         Progress& progress, WorkReport& report);

} // namespace kokage

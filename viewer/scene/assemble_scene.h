#pragma once
// SceneDescription -> one tree of many stems and everything else that light and camera need.
//
// All trees and objects become ONE Tree, so that patches, transport and picture need no more than one: trees keep their
// leaves and bark; an object becomes bark-like parts, opaque, cut into patches. What mirrors does not scatter twice:
// the patches' optics are lessened by their gloss' mean reflectance (reflection/gloss.h).
#include "common/environment/environment.h"
#include "common/services/progress.h"
#include "common/services/work_report.h"
#include "reflection/picture.h"
#include "trees/patches.h"
#include "viewer/scene/scene_description.h"

namespace kokage {

struct AssembledScene {
    Tree tree;
    PatchScene patches;
    PatchOrigins origins;
    Environment environment;
    EnvironmentReport environment_report;
    std::vector<SurfaceLook> looks;           ///< with gloss and relief
    std::vector<std::uint32_t> triangle_look; ///< per triangle of `patches`
    Camera camera;
    WorkReport report; ///< stages, counts, skips, warnings
};

/// Loads, grows, places, merges. Memory is estimated before it is taken (InputError says what to reduce). Throws
/// InputError, Stopped.
AssembledScene assemble_scene(const SceneDescription& description, Progress& progress);

} // namespace kokage

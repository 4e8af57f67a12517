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
    std::vector<SurfaceLook> looks;           ///< of each of the tree's parts, with gloss and relief
    std::vector<std::uint32_t> triangle_look; ///< per triangle of `patches`
    std::size_t tree_parts = 0; ///< so many of the tree's parts are of trees; the others, after them, of objects
    float foot_height = 0;      ///< of the lowest foot, where the ground is
    Camera camera;
    WorkReport report; ///< stages, counts, skips, warnings
};

/// What pictures are made of, still without light: for path tracing. `scene` must outlive it.
ShadedScene unlit_scene(const AssembledScene& scene);

struct AssemblyOptions {
    bool skip_unworn_materials = true; ///< textures of materials that nothing wears are not loaded
};

/// Loads, grows, places, merges. Memory is estimated before it is taken (InputError says what to reduce). Throws
/// InputError, Stopped.
AssembledScene assemble_scene(const SceneDescription& description, Progress& progress,
                              const AssemblyOptions& options = {});

} // namespace kokage

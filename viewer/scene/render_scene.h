#pragma once
// An assembled scene -> a picture, by the fast way or by tracing paths.
#include "viewer/scene/assemble_scene.h"

namespace kokage {

enum class RenderMethod { fast, path_traced };

struct RenderOptions {
    RenderMethod method = RenderMethod::fast;
    /// Asked of the leaves' light (ShadingOptions::error). Coarser than `shade`'s, because a pixel adds up many leaves:
    /// on an oak's picture 0.15 and 0.05 were 3.95 and 3.88 % from the truth, for 0.13 and 0.73 CPU-s.
    double error = 0.15;
    PictureOptions picture; ///< with what the picture leaves out
    /// What is left out of the light. Weak lights are merged (ShadingOptions); light maps that nothing in view reads
    /// are not made; paths do not check what gathering rays will correct (ShadingOptions::check_by_paths).
    bool merge_weak_lights = true, skip_unread_light_maps = true, skip_check_by_paths = true;
    /// Rough gloss of bark from light maps (reflection/light_map_readers.h); else rays find it.
    bool light_maps = true;
};

struct RenderedScene {
    Picture picture;
    WorkReport report; ///< transport, solve, render (its parts: picture.report): stages, counts, skips, warnings
};

RenderedScene render_scene(const AssembledScene& scene, const RenderOptions& options, Progress& progress);

} // namespace kokage

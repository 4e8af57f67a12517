#pragma once
// An assembled scene -> a picture, by the fast way or by tracing paths.
#include "viewer/scene/assemble_scene.h"

namespace kokage {

enum class RenderMethod { fast, path_traced };

struct RenderOptions {
    RenderMethod method = RenderMethod::fast;
    double error = 0.05; ///< asked of the leaves' light (ShadingOptions::error)
    PictureOptions picture;
};

struct RenderedScene {
    Picture picture;
    WorkReport report; ///< transport, solve, render (its parts: picture.report): stages, counts, skips, warnings
};

RenderedScene render_scene(const AssembledScene& scene, const RenderOptions& options, Progress& progress);

} // namespace kokage

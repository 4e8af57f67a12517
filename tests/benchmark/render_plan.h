#pragma once
// Which pictures the renderer's benchmark draws, how large, and with which efforts.
#include "viewer/scene/render_scene.h"

#include <vector>

namespace kokage {

struct FastEffort {
    double error; ///< asked of the leaves' light
    int samples;
};

struct RenderPlan {
    int width, height;
    int every_row, every_column; ///< of the truth: one of all pixels would take hours
    std::uint64_t truth_samples; ///< at least
    std::vector<FastEffort> fast;
    std::vector<int> traced; ///< samples a pixel
    int map_samples;         ///< of the small path-traced picture that errors are shown against
};

/// The whole benchmark, or the part of it that ends within five minutes on two cores where truths are stored.
RenderPlan render_plan(bool quick);

/// The picture's options with the pixels that are judged.
PictureOptions judged_pixels(const RenderPlan& plan, const PictureOptions& picture);

} // namespace kokage

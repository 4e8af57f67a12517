#pragma once
// The truth of a picture, and how far others are from it.
#include "tests/benchmark/render_record.h"
#include "viewer/scene/render_scene.h"

namespace kokage {

struct RenderTruth {
    Image radiance;   ///< mean of two halves
    double noise = 0; ///< mean over judged pixels and channels of half the halves' difference, over the mean
    double mean = 0;  ///< of radiance over the judged pixels and channels
    std::vector<std::uint32_t> pixels; ///< judged: y width + x; rows that were traced, pixels that show anything near
    std::vector<std::uint8_t> kind;    ///< of each of them, number in pixel_kinds()
    double cpu_seconds = 0;
};

/// leaf, bark, object, ground, edge (more than one of them, or sky), by rays through a pixel's middle and corners.
const std::vector<std::string>& pixel_kinds();

/// By tracing `samples` paths a pixel, in two halves, on every so many rows.
RenderTruth find_truth(const AssembledScene& scene, const PictureOptions& picture, int samples, int every_row,
                       Progress& progress);

/// Sets the errors of a record.
void judge(const Image& radiance, const RenderTruth& truth, PictureRecord& record);

} // namespace kokage

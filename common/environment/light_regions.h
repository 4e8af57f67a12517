#pragma once
// Bright regions of a lat-long image: which pixels are bright, which of them belong together, what surrounds them.
// Used by split_lights.h, where the rules are stated.
#include "common/scene/image.h"
#include "common/types.h"

#include <vector>

namespace kokage {

/// Pixels begin <= x < end of row y.
struct PixelRun {
    int y, begin, end;
};

struct BrightPixels {
    double threshold = 0;             ///< brightness above which a pixel is bright
    double background = 0;            ///< solid-angle mean brightness of the others
    glm::dvec3 background_color{0.0}; ///< the same per channel
    double total = 0;                 ///< integral of brightness over the sphere
    std::vector<PixelRun> runs;       ///< of bright pixels, in raster order
};
BrightPixels find_bright_pixels(const Image& image, double brightness_ratio);

struct LightRegion {
    std::vector<PixelRun> runs; ///< in raster order
    double excess = 0;          ///< integral of brightness - background
};
/// Runs of pixels brighter than a threshold within runs (in raster order; so is the result).
std::vector<PixelRun> brighter_runs(const Image& image, const std::vector<PixelRun>& within, double threshold);

/// Regions in raster order of their first pixel. Two runs are joined if pixels of theirs are neighbours (8 of them; all
/// pixels of the first row are, and of the last, because they meet at a pole) or their centres are at most gap_degrees
/// apart.
std::vector<LightRegion> connect_regions(const Image& image, const std::vector<PixelRun>& runs, double background,
                                         double gap_degrees);

double least_brightness(const Image& image, const LightRegion& region);

/// Half angle in degrees of the cone around the region's mean direction, weighted by its light, that holds all its
/// pixels' centres.
double cone_degrees(const Image& image, const LightRegion& region);

/// Mean colour of the pixels at most as bright as `threshold` within gap_degrees of the region; `background` if there
/// are none.
glm::dvec3 surrounding_color(const Image& image, const LightRegion& region, double threshold,
                             const glm::dvec3& background, double gap_degrees);

} // namespace kokage

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
/// Regions in raster order of their first pixel. Two runs are joined if pixels of theirs are neighbours (8 of them; all
/// pixels of the first row are, and of the last, because they meet at a pole) or their centres are at most gap_degrees
/// apart.
std::vector<LightRegion> connect_regions(const Image& image, const BrightPixels& bright, double gap_degrees);

/// Mean colour of the pixels that are not bright, within gap_degrees of the region; the background if there are none.
glm::dvec3 surrounding_color(const Image& image, const LightRegion& region, const BrightPixels& bright,
                             double gap_degrees);

} // namespace kokage

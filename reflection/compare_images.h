#pragma once
// How far two pictures or maps are apart, in figures and as a picture.
#include "common/scene/image.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace kokage {

/// Figures of one channel or of all together; d = a - b.
struct DifferenceFigures {
    double mean = 0; ///< of |d|
    double rms = 0;  ///< root of the mean of d²
    double p95 = 0;  ///< 95th percentile of |d|
    double max = 0;  ///< of |d|
    double bias = 0; ///< mean of d
    /// Mean of |d| / max(|b|, 0.05 x mean of |b|): as errors of leaves are given. None where b is black throughout.
    std::optional<double> relative;
};

struct ImageComparison {
    DifferenceFigures all;                        ///< over all pixels and channels
    std::array<DifferenceFigures, 4> per_channel; ///< the first `channels` are set
    int channels = 0;
    int max_x = 0, max_y = 0;       ///< the first pixel, in raster order, that has all.max
    std::size_t skipped_values = 0; ///< not finite in a or b: in no figure
    float map_scale = 0; ///< |d| that has the map's brightest colour: the 99th percentile of a pixel's largest |d| (the
                         ///< maximum, if that is 0)
    /// Error map, sRGB ready for display: every pixel's largest |d| / map_scale through the colours of `inferno`
    /// (even steps to the eye, also in grey): 0 = black, 0.25 = violet, 0.5 = red-purple, 0.75 = orange, 1 and above =
    /// pale yellow. Pixels with values that are not finite are green.
    Image map;
};

/// Compares `a` with the reference `b`, channel by channel (up to 4).
/// Throws InputError if their sizes or channel counts differ or they are empty.
ImageComparison compare_images(const Image& a, const Image& b);

/// The colour scale of the map for t in 0 … 1, as a strip for a legend: width x height, 0 at the left.
Image error_legend(int width, int height);

/// What the map's colours mean, for people: the errors that its named colours stand for, from 0 to `scale`, each times
/// `unit` and with `suffix` behind it: "black 0, violet 0.25, red-purple 0.5, orange 0.75, pale yellow 1 and above". At
/// scale 0 that nothing differs.
std::string error_legend_text(double scale, double unit, const std::string& suffix);

/// The figures in one line a person can read.
std::string describe(const ImageComparison& comparison);

} // namespace kokage

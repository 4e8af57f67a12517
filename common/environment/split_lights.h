#pragma once
// Lights are split off an image first: a sun or lamp of a few pixels ruins any smooth basis and any sparse sampling of
// directions.
#include "common/environment/environment.h"
#include "common/scene/image.h"

namespace kokage {

/// The rule. Brightness of a pixel = mean of its three channels; background = solid-angle mean brightness of what is
/// not bright.
///   1. A pixel is bright where it exceeds `brightness_ratio` x background. (Taking bright pixels out lowers the
///   background: repeated
///      until it stands still.)
///   2. Bright pixels no farther apart than `gap_degrees` belong to one region, across the image's left and right
///   border and over the poles.
///   3. A region is a light if its excess over the background is at least `least_share` of the whole image's
///   irradiance. The others,
///      stars and glints, stay: what so little light makes a smooth basis ring is below what one sees.
///   4. A region that does not fit into a cone of `max_half_angle_degrees` is no light but a sky between trees or a row
///   of lamps: the
///      threshold is doubled within it until its parts are smaller. What is both wide and even stays; that wide, it is
///      smooth enough.
///   5. At most `max_lights` are taken, those with most light.
/// A light takes of each of its pixels what exceeds the mean of the pixels around the region; that mean, or the pixel
/// itself where a channel is darker, stays in the remainder. So lights + remainder is exactly the image, and neither is
/// negative.
/// The figures were chosen on eight photographed environments: a sun, or each lamp of a hall, is one light of a few
/// degrees; the sky between the trees of a forest gives a dozen, not a thousand; an overcast sky none.
struct LightSplitting {
    double brightness_ratio = 24;
    double gap_degrees = 1.5;
    double least_share = 0.002;
    double max_half_angle_degrees = 30;
    int max_lights = 64;
    /// Pixels of a region are merged, neighbours first, until there are no more pieces than this: a light stays cheap
    /// to sample.
    int max_texels = 64;
};

struct LightSplit {
    Image remainder;                  ///< as large as the image, 3 channels
    std::vector<DistantLight> lights; ///< most irradiance first
    std::size_t regions_found = 0;    ///< that are lights by rules 1 to 4, before rule 5
};

/// `image`: lat-long, at least 3 channels, finite and not negative (see load_environment.h). Throws InputError if it is
/// empty.
LightSplit split_lights(const Image& image, const LightSplitting& splitting = {});

/// Integral of luminance over the sphere with exact solid angles, in double.
double luminance_integral(const Image& lat_long);
/// The same per channel.
glm::dvec3 radiance_integral(const Image& lat_long);

} // namespace kokage

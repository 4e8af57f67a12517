#pragma once
// How far two maps of filtered light are apart, whatever containers they are kept in.
#include "common/scene/image.h"
#include "reflection/maps/filtered_map.h"

#include <optional>
#include <vector>

namespace kokage {

/// Over all directions of a set and all channels, all directions weighing the same; d = a - b.
struct MapDifference {
    double mean_255 = 0, max_255 = 0;           ///< of |d| with both clamped to [0,1], times 255
    double mean_absolute = 0, max_absolute = 0; ///< of |d|
    std::optional<double> mean_relative;        ///< mean |d| over mean |b|; none where b is black
    std::optional<double> max_relative;         ///< of |d| / max(|b|, 1e-3 x mean |b|); none where b is black
    glm::vec3 worst_direction{0};               ///< where max_relative is, or else max_absolute
};

struct MapComparison {
    struct OfLobe {
        double parameter = 0;
        MapDifference difference;
    };
    MapDifference all;          ///< means over all lobes of `lobes`, the largest of all
    double worst_parameter = 0; ///< the lobe of all.worst_direction
    std::vector<OfLobe> lobes;  ///< from the least parameter to the largest
    std::size_t directions = 0; ///< of each lobe: a Fibonacci sphere
};

/// Compares `a` with the reference `b` over the lobes that both hold: those that a cube map holds without
/// interpolation, if one is a cube map (`b` first), else `lobes` of them, evenly in the logarithm of their width.
/// Throws InputError if they hold lobes of different kinds, or none that both hold.
MapComparison compare_maps(const FilteredMap& a, const FilteredMap& b, int directions = 20000, int lobes = 17);

/// A map at one lobe, as a lat-long image (common/environment/lat_long.h): to look at.
Image lat_long_of_map(const FilteredMap& map, double parameter, int width);

} // namespace kokage

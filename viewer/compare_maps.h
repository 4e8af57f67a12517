#pragma once
// How far two files of filtered light are apart: shells or voxel cubes (.exr), cube maps (.ktx2, .dds).
#include "reflection/maps/compare_maps.h"

#include <filesystem>

namespace kokage {

/// Whether a file is such a map: by its ending, or by what an EXR file says of itself.
bool is_reflection_map(const std::filesystem::path& path);
/// Throws InputError for what can't be read.
FilteredMap load_reflection_map(const std::filesystem::path& path);

/// A few of the lobes that were compared, side by side as lat-long images from rough to smooth, downwards.
Image pictures_of_map(const FilteredMap& map, const MapComparison& comparison);

} // namespace kokage

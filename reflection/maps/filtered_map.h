#pragma once
// Any container of filtered light, seen as what it is: a function of direction and lobe.
#include "reflection/maps/prefiltered_cube.h"
#include "reflection/maps/shell_map.h"
#include "reflection/maps/voxel_cube.h"

#include <functional>
#include <span>
#include <string>
#include <vector>

namespace kokage {

struct FilteredMap {
    LobeKind kind = LobeKind::phong;
    double least_parameter = 0, most_parameter = 0; ///< the lobes that it holds
    /// The lobes that it holds without interpolation; empty where any is as good as another.
    std::vector<double> own_lobes;
    std::string description; ///< one line: "shells, phong 1 to 5000, 18 shells, 1.38 MB as half"
    /// Filtered radiance in unit directions at one lobe, interpolated as hosts do. Thread-safe.
    std::function<void(std::span<const glm::vec3> directions, double parameter, std::span<glm::vec3> filtered)> lookup;
};

FilteredMap filtered_map(ShellMap map);
FilteredMap filtered_map(VoxelCube cube);
/// Between levels linearly in roughness (Phong: in lobe_width). The level that is the image itself is left out.
/// Throws InputError if there is no filtered level.
FilteredMap filtered_map(PrefilteredCube cube);

} // namespace kokage

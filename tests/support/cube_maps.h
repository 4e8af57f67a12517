#pragma once
// Cube maps for tests.
#include "reflection/maps/prefiltered_cube.h"

#include <cmath>

namespace kokage {

/// Every level a smooth function of direction, another one a level, from 0.05 to 2.05, so that no texel is like
/// another and no axis can be taken for another.
inline void fill_smoothly(PrefilteredCube& cube) {
    for (std::size_t i = 0; i < cube.levels.size(); ++i) {
        PrefilteredCube::Level& level = cube.levels[i];
        for (int face = 0; face < 6; ++face)
            for (int y = 0; y < level.size; ++y)
                for (int x = 0; x < level.size; ++x) {
                    const glm::dvec3 d = cube_texel_direction(face, x, y, level.size);
                    level.texels[cube_texel_index(face, x, y, level.size)] =
                        glm::vec3(1.05 + std::sin(3 * d.x + double(i)), 1.05 + 0.9 * d.y + 0.1 * d.x * d.z,
                                  1.05 + std::cos(2 * d.z - d.x));
                }
    }
}

inline PrefilteredCube smooth_cube(const CubeSettings& settings) {
    PrefilteredCube cube = empty_cube(settings);
    fill_smoothly(cube);
    return cube;
}

} // namespace kokage

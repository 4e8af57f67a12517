#pragma once
// Which corners of smooth surfaces' triangles are one. Private to reflection.
#include "reflection/picture.h"

#include <array>
#include <vector>

namespace kokage {

struct SmoothCorners {
    /// Numbers of each triangle's corners, if it is smooth (SurfaceLook::smooth_normals); empty: no triangle is.
    std::vector<std::array<std::uint32_t, 3>> of_triangle;
    std::uint32_t count = 0;
};

/// Corners are one where place and look are the same and normals nearly so: texture seams double them, while at hard
/// edges surfaces meet that face other light.
SmoothCorners smooth_corners(const ShadedScene& scene);

} // namespace kokage

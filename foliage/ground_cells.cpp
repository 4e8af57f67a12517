#include "foliage/ground_cells.h"

#include <algorithm>
#include <cmath>

namespace kokage {

std::size_t GroundCells::cell(const glm::vec3& point) const {
    const float x = (point.x - low.x) / cell_m, z = (point.z - low.y) / cell_m;
    if (!(x >= 0 && z >= 0 && x < float(side) && z < float(side)))
        return far_cell();
    return std::size_t(z) * std::size_t(side) + std::size_t(x);
}

glm::vec3 GroundCells::centre(std::size_t near_cell) const {
    const std::size_t x = near_cell % std::size_t(side), z = near_cell / std::size_t(side);
    return {low.x + (float(x) + 0.5f) * cell_m, height_m, low.y + (float(z) + 0.5f) * cell_m};
}

GroundCells make_ground_cells(const PatchScene& scene, int side) {
    GroundCells grid;
    if (!scene.ground)
        return grid;
    const Bounds bounds = bounds_of(scene);
    const glm::vec3 size = bounds.high - bounds.low, centre = bounds.centre();
    const float extent = std::max({size.x, size.z, 1e-30f}) + 2 * std::max(0.f, bounds.high.y - scene.ground->height_m);
    grid.side = side;
    grid.cell_m = extent / float(side);
    grid.low = glm::vec2(centre.x, centre.z) - 0.5f * extent;
    grid.height_m = scene.ground->height_m;
    grid.albedo = scene.ground->albedo;
    return grid;
}

} // namespace kokage

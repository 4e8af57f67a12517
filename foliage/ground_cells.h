#pragma once
#include "common/scene/patch_scene.h"
#include "common/types.h"

#include <cstddef>

namespace kokage {

/// The ground plane cut into square cells of one radiance each, around and under the tree, plus one cell for all that
/// is farther away (and in no shade). Without a ground there are no cells. In metres, for methods that trace
/// rays; bundles have a finer grid of their own, in scaled units (bundles::GroundGrid).
struct GroundCells {
    int side = 0;       ///< cells along x and along z; 0 without a ground
    glm::vec2 low{0.f}; ///< x and z of the corner of cell 0
    float cell_m = 0;   ///< edge of a cell
    float height_m = 0;
    glm::vec3 albedo{0.f};

    std::size_t size() const { return side == 0 ? 0 : std::size_t(side) * std::size_t(side) + 1; }
    std::size_t far_cell() const { return std::size_t(side) * std::size_t(side); }
    /// The cell under a point; size() must not be 0.
    std::size_t cell(const glm::vec3& point) const;
    glm::vec3 centre(std::size_t near_cell) const;
};

/// A grid that reaches beyond the scene's footprint by the scene's height, where most of the shade falls.
GroundCells make_ground_cells(const PatchScene& scene, int side = 16);

} // namespace kokage

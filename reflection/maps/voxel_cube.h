#pragma once
// The paper's container: a cube of voxels, direction = where from the centre, smoothness λ = how far ([R] eqs 6, 7).
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/texel_layout.h"

#include <span>
#include <vector>

namespace kokage {

/// Voxel (x, y, z), x fastest, of size³. In the cube's own frame, -1 … 1 from face to face of the paper's s voxels,
/// with a border of guard voxels outside so that λ = 1 is filtered from voxels on both sides. (The layout of the
/// guards, what the centre holds, and the error of trilinear lookup are documented here by who builds this.)
class VoxelCube {
  public:
    VoxelCube(int size, LobeKind kind, const RoughnessScale& scale);
    int size() const { return size_; } ///< voxels along an edge, guards included
    const TexelLayout& layout() const { return layout_; }
    void set_texels(std::span<const glm::vec3> filtered); ///< in the layout's order
    std::span<const glm::vec3> voxels() const { return voxels_; }

    /// Trilinear, as a 3D texture does it. `direction` unit, `smoothness` in [0,1].
    glm::vec3 lookup(const glm::vec3& direction, float smoothness) const;
    void lookup(std::span<const glm::vec3> directions, std::span<const float> smoothness,
                std::span<glm::vec3> filtered) const;

  private:
    int size_;
    RoughnessScale scale_;
    TexelLayout layout_;
    std::vector<std::size_t> voxel_of_texel_;
    std::vector<glm::vec3> voxels_;
};

} // namespace kokage

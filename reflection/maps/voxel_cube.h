#pragma once
// The paper's container: a cube of voxels, direction = where from the centre, smoothness λ = how far ([R] eqs 6, 7).
//
//        +---+===+===+===+===+---+      s = 4: a cut through the middle, x to the right, y upwards.
//        | g | g | g | g | g | g |      = and ‖: faces of the paper's s³ voxels, from -1 to 1 in the cube's frame;
//        +---+---+---+---+---+---+      the sphere λ = 1 touches them. g: guard voxels, one all round, so that the
//        ‖ g |   |   |   |   | g ‖      stored cube is n = s + 2 voxels wide and a lookup at λ = 1 has voxels on both
//        +---+---+---+---+---+---+      sides of it.
//        ‖ g |   |   |   |   | g ‖      Voxel (x, y, z), x fastest, has its centre at the vector
//        +---+---+---o---+---+---+          t = ((x, y, z) - (n-1)/2) 2/s,        o: t = 0
//        ‖ g |   |   |   |   | g ‖      and holds F(t/|t|, g(|t|)) of [R] eq 8, Λ = g(λ) by RoughnessScale, which
//        +---+---+---+---+---+---+      simply goes on beyond λ = 1 in the guards. A GGX cube holds the lobe of
//        ‖ g |   |   |   |   | g ‖      roughness_from_exponent(g(λ)), at most 1.
//        +---+---+---+---+---+---+      Texture coordinates (of n³): 0.5 + λ r (s/2)/n.
//        | g | g | g | g | g | g |
//        +---+===+===+===+===+---+
//
// Corners: voxels that no lookup with λ <= 1 reads hold 0 and are no texels of the layout (48 % of the cube).
// Centre: s is even, so that the point t = 0, where the direction is undefined, lies between eight voxels, whose
// lobes (Λ = 4.3 where s = 128, I = 256) all have a direction. A trilinear lookup in the middle of them is their mean
// whatever the direction, whereas F of even the widest Phong lobe (Λ = 0, half the sphere) depends on it. Along a ray,
// trilinear interpolation there raises the share of the first band in proportion to the distance from the centre; half
// a voxel from it that share is about that of Λ = 0. So lookups go no nearer to the centre than half a voxel
// (least_smoothness()). Eq 13 squeezes the whole of Λ < 3 into that half voxel: such rough lobes are the cube's
// coarsest error, and shells (shell_map.h) hold them right.
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/texel_layout.h"

#include <span>
#include <vector>

namespace kokage {

class VoxelCube {
  public:
    /// s = scale.cube_size(), even, 4 … 1022. Throws InputError otherwise.
    VoxelCube(LobeKind kind, const RoughnessScale& scale);
    int size() const { return size_; } ///< voxels along an edge, guards included: s + 2
    const RoughnessScale& scale() const { return scale_; }
    const TexelLayout& layout() const { return layout_; }
    void set_texels(std::span<const glm::vec3> filtered); ///< in the layout's order
    std::span<const glm::vec3> voxels() const { return voxels_; }
    /// Index into voxels() of each texel of the layout, ascending.
    std::span<const std::size_t> voxel_of_texel() const { return voxel_of_texel_; }

    /// Trilinear, as a 3D texture does it. `direction` unit, `smoothness` in [0,1] (clamped). Thread-safe.
    glm::vec3 lookup(const glm::vec3& direction, float smoothness) const;
    void lookup(std::span<const glm::vec3> directions, std::span<const float> smoothness,
                std::span<glm::vec3> filtered) const;
    /// λ of a lobe of the cube's kind: Λ, or glTF's roughness.
    float smoothness(double parameter) const;
    float least_smoothness() const { return 1.f / float(size_ - 2); } ///< half a voxel: nearer lookups are done there

  private:
    int size_;
    RoughnessScale scale_;
    TexelLayout layout_;
    std::vector<std::size_t> voxel_of_texel_;
    std::vector<glm::vec3> voxels_;
};

} // namespace kokage

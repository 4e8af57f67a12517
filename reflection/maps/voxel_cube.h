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
//        +---+---+---+---+---+---+      Texture coordinates: 0.5 + r ρ/n, ρ = λ s/2 (see Centre).
//        | g | g | g | g | g | g |
//        +---+===+===+===+===+---+
//
// Corners: voxels that no lookup with λ <= 1 reads hold 0 and are no texels of the layout (48 % of the cube).
// A range of smoothness [a, b]: the voxels keep their places and lobes, but only those that lookups within the range
// read are stored (n = b s + 2 at least, the corners of a smaller cube cut off) and are texels of the layout (those
// near the centre are not). Lookups outside of the range give its nearest end.
// Centre: s is even, so that the point t = 0, where the direction is undefined, lies between eight voxels, whose
// lobes (Λ = 4.3 where s = 128, I = 256) all have a direction. A trilinear lookup in the middle of them is their mean
// whatever the direction, whereas F of even the widest Phong lobe (Λ = 0, half the sphere) depends on it; and eq 13
// squeezes all of Λ < 3 into the innermost half voxel. Around there, trilinear interpolation raises the share of the
// first band in proportion to the distance from the centre, and reaches that of Λ = 0 … 3 only at 0.5 to 0.8 voxels. So
// a lookup at ρ voxels from the centre is done at sqrt(ρ² + 1), which matters for the rough lobes alone (ρ = 64 becomes
// 64.008, at most the sphere). Mean error of s = 128 on a photograph in [0,1], against brute force, of 255, without |
// with this:   Λ = 2: 17 | 5.4   3: 13 | 5.7   4.3: 13 | 5.1   7: 6.7 | 3.7   10: 4.6 | 2.9   25: 2.4 | 2.0
//              100: 1.5 | 1.4   325: 1.1   1000: 0.7   5000: 0.4.          Shells (shell_map.h) stay below 0.2.
#include "reflection/maps/roughness_scale.h"
#include "reflection/maps/texel_layout.h"

#include <span>
#include <vector>

namespace kokage {

class VoxelCube {
  public:
    /// s = scale.cube_size(), even, 4 … 1022; `range` within 0 and 1, the rough end first. Throws InputError otherwise.
    VoxelCube(LobeKind kind, const RoughnessScale& scale, const SmoothnessRange& range = {});
    /// What a cube has, before any memory is taken. Throws InputError as the constructor does.
    struct Extent {
        int size = 0;           ///< voxels along an edge, guards included: s + 2 for the whole range
        std::size_t texels = 0; ///< of the layout
    };
    static Extent extent(int cube_size, const SmoothnessRange& range = {});
    int size() const { return size_; } ///< Extent::size
    const RoughnessScale& scale() const { return scale_; }
    const SmoothnessRange& range() const { return range_; }
    const TexelLayout& layout() const { return layout_; }
    void set_texels(std::span<const glm::vec3> filtered); ///< in the layout's order
    std::span<const glm::vec3> voxels() const { return voxels_; }
    /// Index into voxels() of each texel of the layout, ascending.
    std::span<const std::size_t> voxel_of_texel() const { return voxel_of_texel_; }

    /// Trilinear, as a 3D texture does it. `direction` unit, `smoothness` λ, clamped to the range. Thread-safe.
    glm::vec3 lookup(const glm::vec3& direction, float smoothness) const;
    void lookup(std::span<const glm::vec3> directions, std::span<const float> smoothness,
                std::span<glm::vec3> filtered) const;
    /// λ of a lobe of the cube's kind: Λ, or glTF's roughness.
    float smoothness(double parameter) const;
    /// Lookups at the distance ρ from the centre are done at sqrt(ρ² + centre_radius²), in voxels.
    static constexpr float centre_radius = 1;

  private:
    SmoothnessRange range_;
    int size_;
    RoughnessScale scale_;
    TexelLayout layout_;
    std::vector<std::size_t> voxel_of_texel_;
    std::vector<glm::vec3> voxels_;
};

} // namespace kokage

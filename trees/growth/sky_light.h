#pragma once
// How much skylight reaches the places in a crown: a coarse grid of spherical harmonics.
#include "common/types.h"

#include <array>
#include <vector>

namespace kokage {

/// The foliage of other trees around: a layer as deep as the crown, everywhere but in the crown's own place.
struct Neighbours {
    double leaf_area_density = 0; ///< m2 per m3; 0: the tree stands alone
    float base_m = 0, top_m = 0;
};

/// The crown's leaf area as a density in the cells of a coarse grid; at the cells' corners the light of an evenly
/// bright sky that comes through (Beer's law, leaves facing all ways: Monsi and Saeki 1953), as spherical harmonics of
/// two bands. It decides which twigs live and where branches turn to; it is not the light that the tree is shown in.
class SkyLight {
  public:
    /// `points` stand for `leaf_area_m2` together, each for as much as the others.
    SkyLight(const std::vector<glm::vec3>& points, double leaf_area_m2, const Neighbours& neighbours = {});

    /// Light from all directions at a place over that under the open sky, 0..1.
    float relative(const glm::vec3& place) const;
    /// Where the light comes from: mean direction, shorter the more sides it comes from.
    glm::vec3 direction(const glm::vec3& place) const;

  private:
    using Coefficients = std::array<float, 4>; ///< Y_00, then Y_1 in y, z, x
    Coefficients at(const glm::vec3& place) const;

    glm::vec3 low_{0.f};
    float cell_ = 1;
    glm::ivec3 cells_{1};
    std::vector<Coefficients> corners_;
};

} // namespace kokage

#pragma once
// First light: what reaches the sides of patches from sky, lights and ground without being scattered by another patch,
// from the ends of line bundles.
#include "foliage/bundles/drawn_bundles.h"
#include "foliage/ground_in_view.h"
#include "foliage/light_map_field.h"

namespace kokage {

struct FirstLight {
    SideIrradiance sky, lights;
    std::vector<float> open_front, open_back; ///< cosine-weighted share of the side's hemisphere that sees the sky
};

/// Lines are drawn once; another environment costs sums over them, and new rasters only of lights that moved.
class FirstLightByBundles {
  public:
    /// `directions` of lines (at least 4); lights are drawn in proportion. `scene` must outlive it. Stages go to
    /// `report`.
    FirstLightByBundles(const PatchScene& scene, const GroundCells& ground, int directions, std::uint64_t seed,
                        Progress& progress, WorkReport& report);

    /// Lights that together give less than `negligible` of all light are merged into their neighbours.
    FirstLight of(const Environment& environment, double negligible, Progress& progress, WorkReport& report);
    /// What ground cells of this radiance (as long as the grid, or empty: dark) send to the sides.
    SideIrradiance from_ground(std::span<const glm::vec3> radiance) const;
    /// Cosine-weighted share of every side's hemisphere that other patches fill: neither sky nor ground. 1 for the back
    /// of bark.
    void filled_shares(std::vector<float>& front, std::vector<float>& back) const;
    /// Mean direction in which both sides of each patch see the sky; unit, or 0.
    std::vector<glm::vec3> bent_normals() const;

    void count(WorkReport& report) const { drawn_.count(report); }
    std::size_t bytes() const;

  private:
    std::uint64_t seed_;
    bundles::DrawnBundles drawn_;
    bundles::SideLight open_; ///< without light: what sides see of sky and ground
    GroundInView ground_;
};

} // namespace kokage

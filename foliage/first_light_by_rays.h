#pragma once
// First light: what reaches the sides of patches from sky and lights without being scattered, by stratified rays from
// every patch.
#include "foliage/light_map_field.h"
#include "foliage/light_visibility.h"
#include "foliage/patch_points.h"

namespace kokage {

struct FirstLight {
    SideIrradiance sky, lights;
    std::vector<float> open_front, open_back; ///< cosine-weighted share of the side's hemisphere that sees the sky
    std::vector<glm::vec3> bent_normal;       ///< mean open direction of both sides together, unit or 0
};

/// Rays are traced once; another environment costs sums over them, and rays only towards lights that moved.
class FirstLightByRays {
  public:
    /// `rays_a_side` (at least 1) cosine-distributed rays from stratified points. As many go to the lights together, at
    /// least 2 to each: many lights average out by themselves.
    FirstLightByRays(const RayQueries& queries, const GroundCells& ground, int rays_a_side, std::uint64_t seed,
                     Progress& progress);

    FirstLight of(const Environment& environment, Progress& progress);
    /// What ground cells of this radiance (as long as the grid) send to the sides unscattered.
    SideIrradiance from_ground(std::span<const glm::vec3> radiance) const;
    /// Cosine-weighted share of every side's hemisphere that other patches fill: neither sky nor ground.
    void filled_shares(std::vector<float>& front, std::vector<float>& back) const;
    std::uint64_t rays_traced() const { return rays_; }
    std::size_t bytes() const;

  private:
    /// Per patch: what reaches front and back from a light of irradiance 1 on a facing surface (distant), or of
    /// intensity 1 (point).
    struct LightTransfer {
        std::vector<glm::vec2> sides;
        bool used = true;
    };
    std::uint16_t look(const glm::vec3& from, const glm::vec3& direction) const;
    const std::vector<glm::vec2>& transfer(const DistantLight& light, int rays, Progress& progress);
    const std::vector<glm::vec2>& transfer(const PointLight& light, int rays, Progress& progress);
    template <class Sample>
    const std::vector<glm::vec2>& trace_light(std::uint64_t light, int rays, const Sample& sample, Progress& progress);

    const RayQueries& queries_;
    PatchPoints points_;
    int rays_a_side_;
    std::uint64_t seed_;
    CaptureDirections cells_; ///< of the sky
    std::vector<std::uint16_t>
        seen_cell_; ///< per patch, side and ray: cell of sky, or cells_.size() + cell of the ground, or kNothing
    GroundCells ground_;
    std::unordered_map<std::uint64_t, LightTransfer> lights_;
    std::uint64_t rays_ = 0;
};

} // namespace kokage

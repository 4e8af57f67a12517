#pragma once
// First light: what reaches the sides of patches from sky and lights without being scattered, by stratified rays from
// every patch.
#include "foliage/light_map_field.h"
#include "foliage/light_visibility.h"

namespace kokage {

struct FirstLight {
    SideIrradiance sky, lights;
    std::vector<float> open_front, open_back; ///< cosine-weighted share of the side's hemisphere that sees the sky
    std::vector<glm::vec3> bent_normal;       ///< mean open direction of both sides together, unit or 0
};

/// Rays are traced once; another environment costs sums over them, and rays only towards lights that moved.
class FirstLightByRays {
  public:
    /// `rays_a_side`: cosine-distributed, from stratified points; `light_rays`: towards each light. Both at least 1.
    FirstLightByRays(const RayQueries& queries, int rays_a_side, int light_rays, std::uint64_t seed,
                     Progress& progress);

    FirstLight of(const Environment& environment, Progress& progress);
    std::uint64_t rays_traced() const { return rays_; }
    std::size_t bytes() const;

  private:
    /// Per patch: what reaches front and back from a light of irradiance 1 on a facing surface (distant), or of
    /// intensity 1 (point).
    struct LightTransfer {
        std::vector<glm::vec2> sides;
        bool used = true;
    };
    const std::vector<glm::vec2>& transfer(const DistantLight& light, Progress& progress);
    const std::vector<glm::vec2>& transfer(const PointLight& light, Progress& progress);
    template <class Sample>
    const std::vector<glm::vec2>& trace_light(std::uint64_t key, const Sample& sample, Progress& progress);

    const RayQueries& queries_;
    int rays_a_side_, light_rays_;
    std::uint64_t seed_;
    CaptureDirections cells_;              ///< of the sky
    std::vector<std::uint16_t> seen_cell_; ///< per patch, side and ray: cell of the sky that is seen, or none
    std::unordered_map<std::uint64_t, LightTransfer> lights_;
    std::uint64_t rays_ = 0;
};

} // namespace kokage

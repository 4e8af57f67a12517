#pragma once
// The light of the ground: what each cell of the plane receives from lights, sky and tree, and sends back.
#include "foliage/light_visibility.h"
#include "foliage/solution.h"

namespace kokage {

class GroundLight {
  public:
    /// Traces what every cell's centre sees. `queries` must outlive it. Without a ground everything is empty.
    GroundLight(const RayQueries& queries, std::uint64_t seed, Progress& progress);

    const GroundCells& grid() const { return grid_; }
    /// Takes in a new environment: its lights and sky on every cell. Lights that did not move are not traced again.
    void set_environment(const Environment& environment, Progress& progress);
    /// Outgoing radiance of every cell under that environment and a lit tree; as long as grid().size().
    std::vector<glm::vec3> radiance(const SideRadiance& tree) const;

    std::uint64_t rays_traced() const;
    std::size_t bytes() const;

  private:
    glm::vec3 irradiance_from_tree(std::size_t cell, const SideRadiance& tree) const;

    GroundCells grid_;
    CaptureDirections sphere_;
    std::vector<std::size_t> upper_;    ///< cells of the sphere above the horizon
    std::vector<float> cosine_weights_; ///< of `upper_`; they add up to pi
    Capture capture_;
    LightVisibility visibility_;
    std::vector<glm::vec3> first_irradiance_; ///< from lights and sky
};

/// Radiance of what a capture ray saw; 0 where it saw the sky. An empty `ground` is dark.
glm::vec3 seen_radiance(std::uint32_t seen, const SideRadiance& tree, std::span<const glm::vec3> ground);

} // namespace kokage

#pragma once
// First hits and occlusion on a PatchScene, by Embree, with alpha masks tested at every candidate hit.
#include "common/scene/patch_scene.h"

#include <memory>
#include <span>

namespace kokage {

struct Ray {
    glm::vec3 origin{0.f}, direction{0, 0, 1}; ///< unit
    float near = 0, far = 0;                   ///< only what lies between counts
};

struct RayHit {
    float distance = 0;
    std::uint32_t triangle = 0;
    glm::vec2 barycentric{0.f};      ///< weights of the triangle's corners 1 and 2
    glm::vec3 geometric_normal{0.f}; ///< unit, counter-clockwise side
    bool ground = false;             ///< the scene's ground plane was hit (triangle is then undefined)
};

/// Embree's acceleration structure over a scene (which must outlive it). Thread-safe once built. The scene may be
/// empty. Triangles without area are left out: no ray hits them. Any scale works: 1e-6 m and 1e6 m trees give the same
/// hits. The environment variable KOKAGE_EMBREE, where there is one, goes to Embree as its settings: "max_isa=avx2"
/// traces as a machine without AVX-512 does.
class RayQueries {
  public:
    explicit RayQueries(const PatchScene& scene);
    ~RayQueries();
    RayQueries(RayQueries&&) noexcept;
    RayQueries& operator=(RayQueries&&) noexcept;

    /// Nearest hit in (near, far); false if none. Surfaces that lie in the ground's plane hide it (ground_plane.h).
    bool first_hit(const glm::vec3& origin, const glm::vec3& direction, float near, float far, RayHit& hit) const;
    /// True if anything solid lies in (near, far).
    bool occluded(const glm::vec3& origin, const glm::vec3& direction, float near, float far) const;
    /// The same for many rays at once, which is faster where neighbours go nearly the same way (camera rays of a pixel,
    /// shadow rays to one light). `found` tells which of `hits` were set. All spans are as long as `rays`. Where
    /// surfaces meet, or a ray passes within rounding of an edge, the answer may be the neighbour's of what a single
    /// ray finds; the same rays in the same order give the same bits.
    void first_hits(std::span<const Ray> rays, std::span<RayHit> hits, std::span<std::uint8_t> found) const;
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> hidden) const;
    /// A distance below which a hit is taken for the surface that a ray left: scaled to the scene's size and place.
    float ray_offset() const;
    const PatchScene& scene() const;
    /// Memory that the acceleration structure holds.
    std::size_t bytes() const;

    struct Implementation; ///< Embree's side of it; opaque

  private:
    std::unique_ptr<Implementation> implementation_;
};

} // namespace kokage

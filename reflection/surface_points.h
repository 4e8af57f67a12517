#pragma once
// From a ray's hit to a point that is ready to be lit: where it lies, how it looks there, which patch's light it has.
#include "common/trace/ray_queries.h"
#include "reflection/picture.h"
#include "reflection/relief_surfaces.h"

namespace kokage {

struct SurfacePoint {
    /// Where rays to lights start; on smooth surfaces lifted onto the rounded surface, above relief on the mesh.
    glm::vec3 point{0.f};
    glm::vec3 geometric_normal{0.f}; ///< unit, on the side that is seen, of the mesh
    glm::vec3 normal{0.f};           ///< unit, on that side: interpolated on smooth surfaces, of relief where there is
    glm::vec3 texture{1.f};          ///< base colour here over its mean
    Optics optics;                   ///< here: the patch's times `texture`
    glm::vec3 gloss{0.f};            ///< K of gloss.h towards the viewer; 0: matt
    glm::vec3 gloss_texture{1.f};    ///< gloss here over its mean: of metals, whose texture colours it
    float roughness = 1;
    std::uint32_t triangle = 0, patch = 0;
    glm::vec3 weights{0.f};              ///< of the triangle's corners
    bool front = true;                   ///< the patch's front is seen
    bool smooth = false;                 ///< SurfaceLook::smooth_normals
    const ReliefPoint* relief = nullptr; ///< hides some directions; null: it lies on the mesh
};

class SurfacePoints {
  public:
    /// Checks that the scene's arrays agree in size (InputError). The scene must outlive it.
    explicit SurfacePoints(const ShadedScene& scene);

    /// `hit` is no ground.
    SurfacePoint at(const glm::vec3& origin, const glm::vec3& direction, const RayHit& hit) const;
    /// Keeps a pointer to the hit's relief.
    SurfacePoint at(const glm::vec3& origin, const CameraHit& hit) const;

  private:
    const SurfaceLook* look_of(std::uint32_t triangle) const;
    SurfacePoint on_mesh(const glm::vec3& point, const RayHit& hit, bool front) const;
    void dress(SurfacePoint& at, const glm::vec3& direction) const;

    const ShadedScene& scene_;
};

} // namespace kokage

#pragma once
// Where camera rays meet a scene, with relief on its bark (relief/surface_relief.h), and what relief hides from there.
//
// A ray that meets a mesh with relief goes on within the relief's shell, then behind its silhouette, until it meets
// relief, or anything else that stands before it. From a point of relief, light and paths are tested within the shell
// first. They leave it on the surface that smooth normals tell of: directions are turned as that surface lies to the
// flat triangle, so that a trunk of few sides is not shaded by its edges, and relief that fades out becomes what the
// mesh shows without it.
#include "common/trace/ray_queries.h"
#include "reflection/camera_rays.h"
#include "reflection/open_irradiance.h"
#include "reflection/relief/surface_relief.h"

#include <memory>
#include <span>

namespace kokage {

class ReliefSurfaces;
struct SceneRelief;

/// A point of relief.
struct ReliefPoint {
    const ReliefSurfaces* surfaces = nullptr;      ///< that it belongs to
    SurfaceHit hit;                                ///< its triangle is of the shell
    glm::vec3 facet_normal{0.f}, mesh_normal{0.f}; ///< unit, outwards, of the mesh above it: flat, and interpolated
    float openness = 1;                            ///< of the sky about its normal, relief_openness.h

    /// 1 where relief hides what lies in `directions` (unit) from here.
    void hides(std::span<const glm::vec3> directions, std::span<std::uint8_t> hidden) const;
    bool hides(const glm::vec3& direction) const;
};

/// What a camera ray meets first of all surfaces.
struct CameraHit {
    glm::vec3 direction{0.f}; ///< of the ray, unit
    bool found = false;
    bool is_relief = false; ///< `hit` tells the distance to relief and the place of the mesh above it
    RayHit hit;
    ReliefPoint relief;

    /// A surface of the scene, where the ground hides those that lie farther (GroundLook::distance_to_surfaces).
    bool shows_surface(float hidden_from) const { return found && !hit.ground && hit.distance <= hidden_from; }
};

class ReliefSurfaces {
  public:
    /// Makes what relief needs (scene_relief.h), if a camera of this frame may see any: the report tells. Both scene
    /// and queries must outlive it. `skip_thin`: relief fades out below three quarters of a pixel (relief_strength) and
    /// is left out below a quarter; else it is traced in full wherever it is in view. Throws InputError, Stopped.
    ReliefSurfaces(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                   const CameraFrame& frame, bool skip_thin, Progress& progress, WorkReport& report);
    ~ReliefSurfaces();
    ReliefSurfaces(const ReliefSurfaces&) = delete;
    ReliefSurfaces& operator=(const ReliefSurfaces&) = delete;

    bool empty() const { return !relief_; }

    /// Of rays from the camera, whose `direction` is given; faster for hundreds at a time.
    void first_hits(std::span<CameraHit> hits) const;

    /// As ReliefPoint's.
    void hides(const ReliefPoint& from, std::span<const glm::vec3> directions, std::span<std::uint8_t> hidden) const;

    /// What a path from a point of relief meets within it; false: it gets out.
    bool meets(const ReliefPoint& from, const glm::vec3& direction, CameraHit& next) const;

    /// Light under the open sky (OpenIrradiance). Not if empty().
    glm::vec3 open_irradiance(const glm::vec3& normal) const { return open_->at(normal); }

  private:
    struct Entry;
    void first_hits_of_meshes(std::span<CameraHit> hits) const;
    Entry entry_at(const RayHit& hit, const glm::vec3& direction) const;
    bool next_entry(CameraHit& hit, Entry& last, float after, float before) const;
    float strength_at(const Entry& entry) const;
    CameraHit met(const SurfaceHit& hit, const glm::vec3& direction) const;

    const ShadedScene& scene_;
    const RayQueries& queries_;
    glm::vec3 eye_;
    float pixel_;
    bool skip_thin_;
    std::unique_ptr<const SceneRelief> relief_; ///< null: there is none in view
    std::optional<OpenIrradiance> open_;        ///< empty likewise
};

/// First hits of a row's camera rays, found for some pixels ahead.
class RowHits {
  public:
    RowHits(const ReliefSurfaces& surfaces, const CameraFrame& frame, const PictureOptions& options, int y)
        : surfaces_(surfaces), frame_(frame), options_(options), y_(y) {}

    /// One for each sample, in their order. `x` must not decrease.
    std::span<const CameraHit> of_pixel(int x);

  private:
    const ReliefSurfaces& surfaces_;
    const CameraFrame& frame_;
    const PictureOptions& options_;
    int y_, first_ = 0, end_ = 0; ///< pixels that are held
    std::vector<CameraHit> hits_;
};

} // namespace kokage

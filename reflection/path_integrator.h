#pragma once
// Light paths that leave the camera: diffuse and glossy scattering, lights and remainder. Private to reflection.
#include "common/trace/light_sampler.h"
#include "common/trace/path_numbers.h"
#include "common/trace/remainder_sampler.h"
#include "reflection/backdrop_ground.h"
#include "reflection/surface_points.h"
#include "reflection/surface_shading.h"

#include <optional>

namespace kokage {

/// Where a path scatters.
struct PathVertex {
    glm::vec3 point{0.f};
    glm::vec3 geometric_normal{0, 1, 0}, normal{0, 1, 0}; ///< unit, on the side that is seen
    Optics optics;
    glm::vec3 gloss{0.f}; ///< K towards where it is seen from
    float roughness = 1;
    glm::vec3 mirrored{0.f};
    std::optional<ReliefPoint> relief; ///< that it lies on
    bool on_backdrop = false;          ///< on a ground that the backdrop plays
};

/// Path tracing after Kajiya 1986 with light sampling. What a light sends through a lobe is found by sampling the light
/// where the lobe is the wider of both, else by sampling the lobe, so that neither makes noise.
///
/// The first backdrop's ground on a path is lit as the scene lets it, the next one is as the image shows it, as it is
/// for solved light. Thread-safe.
class PathIntegrator {
  public:
    /// All must outlive it. `backdrop_ground`: null where the backdrop plays no ground.
    PathIntegrator(const ShadedScene& scene, const RayQueries& queries, const Environment& environment,
                   const BackdropGround* backdrop_ground);

    /// What a vertex sends to where it is seen from: one path with all its bounces.
    SurfaceRadiance radiance(PathVertex vertex, PathNumbers& numbers) const;

    const SurfacePoints& points() const { return points_; }
    PathVertex surface_vertex(const glm::vec3& origin, const glm::vec3& direction, const RayHit& hit) const {
        return surface_vertex(points_.at(origin, direction, hit), direction);
    }
    static PathVertex surface_vertex(const SurfacePoint& at, const glm::vec3& direction);
    static PathVertex ground_vertex(const glm::vec3& point, const glm::vec3& albedo);

  private:
    /// How a path goes on.
    struct Step {
        glm::vec3 direction{0.f}, weight{0.f};
        bool glossy = false;
    };
    LightFromLights light(const PathVertex& vertex, PathNumbers& numbers) const;
    Step scatter(const PathVertex& vertex, PathNumbers& numbers) const;
    Step scatter_diffuse(const PathVertex& vertex, float choice, glm::vec2 place) const;
    glm::vec3 start(const PathVertex& vertex, const glm::vec3& direction) const;

    const RayQueries& queries_;
    const PatchScene& patches_;
    const Environment& environment_;
    const SurfacePoints points_;
    const RemainderSampler remainder_;
    const LightSampler lights_;
    const BackdropGround* backdrop_ground_;
    float remainder_share_ = 0; ///< of diffuse directions, drawn towards the remainder's bright parts
    float offset_ = 0;          ///< metres
};

} // namespace kokage

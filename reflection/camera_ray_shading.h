#pragma once
// What camera rays see: first what each meets and which lights are to be tested there, then, with the light that came
// through, its radiance; so that shadow rays of many camera rays are traced together (light_rays.h). Private to
// reflection.
#include "reflection/backdrop.h"
#include "reflection/gloss_shading.h"
#include "reflection/ground_shading.h"
#include "reflection/light_rays.h"
#include "reflection/relief_surfaces.h"
#include "reflection/seen_by_ray.h"
#include "reflection/surface_shading.h"

namespace kokage {

/// What a camera ray meets, before lights are tested there.
struct UnlitHit {
    enum class Kind : std::uint8_t { surroundings, surface, ground } kind = Kind::surroundings;
    float distance = std::numeric_limits<float>::infinity();
    SampleIndex sample;
    SurfacePoint at;
    UnlitGround ground;
};

/// Everything that rays need to become colours. Thread-safe; one scratch a thread.
struct CameraRayShading {
    const RayQueries& queries;
    const Backdrop& backdrop;
    const LightChoice& lights;
    const SurfaceShading& surfaces;
    const GroundLook& ground;
    const GroundShading& ground_light;
    const GlossShading& gloss;
    const ReliefSurfaces& relief;

    /// Adds rays to lights to `rays`, for `receiver`.
    UnlitHit unlit(const glm::vec3& origin, const CameraHit& hit, SampleIndex sample, std::uint32_t receiver,
                   LightRays& rays, ShadingScratch& scratch) const;
    /// Its part (seen_part) alone.
    std::uint32_t part_met(const glm::vec3& origin, const CameraHit& hit) const;
    /// `light`: what arrived for the hit's receiver. `direction`: of the camera ray.
    SeenByRay lit(const UnlitHit& unlit, const glm::vec3& direction, const LightFromLights& light,
                  ShadingScratch& scratch) const;
};

} // namespace kokage

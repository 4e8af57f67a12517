#pragma once
// The radiance that a shaded surface sends to a camera: solved indirect light, textured, plus the lights tested at this
// very point.
#include "common/trace/ray_queries.h"
#include "reflection/light_choice.h"
#include "reflection/picture.h"
#include "reflection/surface_points.h"

#include <vector>

namespace kokage {

/// Working space of one thread.
struct ShadingScratch {
    std::vector<ShadowRay> rays;
    std::vector<float> weights;
};

/// Traces the chosen lights' shadow rays and adds up what arrives.
glm::vec3 light_from_lights(const LightChoice& lights, const RayQueries& queries, const glm::vec3& point,
                            const Scattering& scattering, SampleIndex sample, ShadingScratch& scratch);

class SurfaceShading {
  public:
    /// Checks that the scene's arrays agree in size (InputError). All three must outlive it.
    SurfaceShading(const ShadedScene& scene, const RayQueries& queries, const LightChoice& lights, bool pixel_shadows);

    /// Radiance at a triangle's hit, towards where the ray came from.
    glm::vec3 radiance(const glm::vec3& origin, const glm::vec3& direction, const RayHit& hit, SampleIndex sample,
                       ShadingScratch& scratch) const;

  private:
    glm::vec3 solved(const SurfacePoint& at) const;
    void smooth_solution();

    const ShadedScene& scene_;
    const RayQueries& queries_;
    const LightChoice& lights_;
    const SurfacePoints points_;
    bool pixel_shadows_;
    /// Solved radiance at the corners of smooth surfaces (per position), the area mean of the patches that meet there.
    std::vector<glm::vec3> smooth_front_, smooth_back_;
};

} // namespace kokage

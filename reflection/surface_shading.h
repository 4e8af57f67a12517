#pragma once
// The radiance that a shaded surface sends to a camera: solved indirect light, textured, plus the lights tested at this
// very point.
#include "common/trace/ray_queries.h"
#include "reflection/light_choice.h"
#include "reflection/patch_gradients.h"
#include "reflection/picture.h"
#include "reflection/smooth_corners.h"
#include "reflection/surface_points.h"

#include <array>
#include <vector>

namespace kokage {

/// Working space of one thread.
struct ShadingScratch {
    std::vector<ShadowRay> rays;
    std::vector<float> weights;
    std::vector<glm::vec3> directions;
    std::vector<std::uint8_t> hidden;
    std::uint64_t met_rays = 0, sky_rays = 0; ///< traced by incoming_radiance.h
};

/// What lights send to a viewer by way of a surface.
struct LightFromLights {
    glm::vec3 scattered{0.f}, reflected{0.f}; ///< by the diffuse surface, and by its gloss
};

/// Chooses the rays from `point` to lights that relief doesn't hide, into `scratch.rays`. `relief`: that the point lies
/// on; null: none.
void choose_light_rays(const LightChoice& lights, const glm::vec3& point, const Scattering& scattering,
                       SampleIndex sample, ShadingScratch& scratch, const ReliefPoint* relief);
/// Traces them, each by itself, and adds up what arrives (many points': light_rays.h).
LightFromLights light_from_lights(const LightChoice& lights, const RayQueries& queries, const glm::vec3& point,
                                  const Scattering& scattering, SampleIndex sample, ShadingScratch& scratch,
                                  const ReliefPoint* relief = nullptr);

/// What a surface sends to a camera, in its parts.
struct SurfaceRadiance {
    glm::vec3 direct{0.f};     ///< from split-off lights
    glm::vec3 indirect{0.f};   ///< from all else
    glm::vec3 reflection{0.f}; ///< by the surface's gloss, of all light
    glm::vec3 total() const { return direct + indirect + reflection; }
};

/// What the gloss of a surface shows to a ray that meets it after the camera's.
struct MetGloss {
    /// The solution's, and all split-off lights; else narrow lights alone: further rays find the rest.
    bool by_solution = true;
    float least_roughness = 0.3f; ///< by which lights are seen: narrower lobes would show one to one ray in a thousand
    float roughness(const SurfacePoint& at) const { return std::max(at.roughness, least_roughness); }
};

/// Where a point finds its solved light: at its patch, or on smooth surfaces at its triangle's corners.
struct LightPlaces {
    std::array<std::uint32_t, 3> places{};
    glm::vec3 weights{1, 0, 0};
};

class SurfaceShading {
  public:
    /// Checks that the scene's arrays agree in size (InputError). All three must outlive it.
    SurfaceShading(const ShadedScene& scene, const RayQueries& queries, const LightChoice& lights, bool pixel_shadows);

    SurfacePoint point(const glm::vec3& origin, const glm::vec3& direction, const RayHit& hit) const {
        return points_.at(origin, direction, hit);
    }
    SurfacePoint point(const glm::vec3& origin, const CameraHit& hit) const { return points_.at(origin, hit); }
    /// Towards where a ray of this direction came from; gloss shows split-off lights alone (gloss_shading.h has the
    /// rest).
    SurfaceRadiance radiance(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                             ShadingScratch& scratch) const;
    /// The parts of radiance(): all but what split-off lights send, and how the surface scatters what they do.
    SurfaceRadiance indirect(const SurfacePoint& at) const;
    static Scattering scattering(const SurfacePoint& at, const glm::vec3& direction);
    /// Else surfaces show the light that was solved, gloss in it as if it scattered.
    bool has_pixel_shadows() const { return pixel_shadows_; }
    /// The solution's, of all light: no ray is traced.
    glm::vec3 solved_radiance(const SurfacePoint& at) const;
    /// For rays that left a point of the scene: solved indirect light, and lights tested at this very point, because
    /// what stands near enough to be met often stands in its light.
    glm::vec3 met_radiance(const SurfacePoint& at, const glm::vec3& direction, const MetGloss& gloss,
                           SampleIndex sample, ShadingScratch& scratch) const;
    /// Radiance of the mesh, untextured: of indirect light, or of all light without shadows per pixel.
    glm::vec3 solved(const SurfacePoint& at) const;

    LightPlaces places(const SurfacePoint& at) const;
    /// Of all sides of all patches and corners.
    std::size_t light_count() const { return light_.size(); }
    const glm::vec3& light(std::uint32_t place) const { return light_[place]; }
    void set_light(std::uint32_t place, const glm::vec3& light) { light_[place] = light; }
    /// Of a patch's place.
    void set_gradient(std::uint32_t place, const PatchGradient& gradient) {
        gradients_.set(light_.size(), place, gradient);
    }

  private:
    glm::vec3 indirect_on_relief(const SurfacePoint& at) const;
    void place_light();
    void smooth_light(std::size_t side, const std::vector<glm::vec3>& of_patches);

    const ShadedScene& scene_;
    const RayQueries& queries_;
    const LightChoice& lights_;
    const SurfacePoints points_;
    bool pixel_shadows_;
    /// `solved` of all fronts, then of all backs; of either: of the patches, then at the corners of smooth surfaces,
    /// which have the area mean of the patches that meet there.
    std::vector<glm::vec3> light_;
    PatchGradients gradients_;
    SmoothCorners corners_;
};

} // namespace kokage

#include "reflection/gloss_shading.h"
#include "common/environment/lat_long.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <limits>

namespace kokage {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kLobePattern = 0x9e3779b9u; ///< makes numbers of its own of a pixel's

} // namespace

GlossShading::GlossShading(const RayQueries& queries, const Environment& environment, const SurfaceShading& surfaces,
                           const GroundLook& ground, const GroundShading& ground_light,
                           const std::optional<RoughnessBounds>& lobes, Progress& progress, WorkReport& report)
    : queries_(queries), environment_(environment), surfaces_(surfaces), ground_(ground), ground_light_(ground_light) {
    if (!lobes)
        return;
    if (!surfaces.has_pixel_shadows()) {
        report.skips.push_back({"reflection map", "patches show the light that was solved, in which gloss is already",
                                "one bake of the surroundings"});
        return;
    }
    // The horizon's correction reads narrower lobes than the surface's own.
    remainder_.emplace(environment, std::clamp(0.4f * lobes->least, kLeastRoughness, 1.f),
                       std::clamp(lobes->most, kLeastRoughness, 1.f), progress, report);
}

glm::vec3 GlossShading::seen_along(const glm::vec3& origin, const glm::vec3& direction, SampleIndex sample,
                                   ShadingScratch& scratch, bool& met) const {
    RayHit hit;
    const float ground_distance = ground_.distance(origin, direction);
    met = true;
    if (queries_.first_hit(origin, direction, queries_.ray_offset(), kInfinity, hit) && !hit.ground &&
        hit.distance <= ground_distance)
        return surfaces_.solved_radiance(surfaces_.point(origin, direction, hit));
    if (ground_distance < kInfinity)
        return ground_light_.radiance(origin, direction, ground_distance, sample, scratch).total;
    met = false;
    return glm::vec3(0.f);
}

glm::vec3 GlossShading::radiance(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                                 ShadingScratch& scratch) const {
    if (!remainder_ || !(at.gloss.r > 0 || at.gloss.g > 0 || at.gloss.b > 0))
        return glm::vec3(0.f);
    const glm::vec3 mirrored = glm::normalize(glm::reflect(direction, at.normal));
    glm::vec3 light = remainder_->radiance(at.normal, mirrored, at.roughness);
    const LobeSample drawn =
        sample_gloss(mirrored, at.roughness, multi_jittered(sample.index, sample.count, sample.pattern ^ kLobePattern));
    if (glm::dot(at.normal, drawn.direction) > 0) {
        bool met = at.relief && at.relief->hides(drawn.direction);
        const glm::vec3 seen = met ? surfaces_.solved_radiance(at) // bark opposite
                                   : seen_along(at.point, drawn.direction, sample, scratch, met);
        light += drawn.weight * (met ? seen - lat_long_radiance(environment_.remainder, drawn.direction)
                                     : wide_lights_in(environment_, drawn.direction, at.roughness));
    }
    return at.gloss * light;
}

} // namespace kokage

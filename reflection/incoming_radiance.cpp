#include "reflection/incoming_radiance.h"
#include "common/environment/lat_long.h"
#include "reflection/glossy_light.h"
#include "reflection/sampling.h"

#include <algorithm>
#include <limits>

namespace kokage {
namespace {

constexpr float kUnbounded = std::numeric_limits<float>::infinity();
/// Make numbers of their own of a pixel's, for each mirror in a row others.
constexpr std::uint32_t kMirrorPattern = 0x85ebca6bu, kChoicePattern = 0xc2b2ae35u;

constexpr int kMostMirrors = 4; ///< in a row; the next shows the solution's gloss
/// Surfaces up to the first roughness mirror by rays, from the second on they show the solution's gloss; between, the
/// one or the other by chance.
constexpr float kAllByRays = 0.3f, kNoneByRays = 0.5f;
/// By which mirrors in mirrors show lights. No lobe shows anything finer than itself, nor do few rays.
constexpr float kFinestLights = 0.12f;
constexpr float kRaysByGloss = 4; ///< chance of a ray over what it is worth (Russian roulette, Arvo and Kirk 1990)

bool mirrors_by_rays(const SurfacePoint& at, SampleIndex sample) {
    if (!(luminance(at.gloss) > 0) || !(at.roughness < kNoneByRays))
        return false;
    const float chance = (kNoneByRays - at.roughness) / (kNoneByRays - kAllByRays);
    return chance >= 1 || stratified(sample.index, sample.count, sample.pattern ^ kChoicePattern) < chance;
}

} // namespace

IncomingRadiance::Met IncomingRadiance::first_met(const glm::vec3& origin, const glm::vec3& direction,
                                                  ShadingScratch& scratch) const {
    ++scratch.met_rays;
    RayHit hit;
    Met met{std::nullopt, ground_.distance(origin, direction)};
    const float hidden_from = ground_.distance_to_surfaces(met.ground_distance, direction);
    if (queries_.first_hit(origin, direction, queries_.ray_offset(), hidden_from, hit) && !hit.ground)
        met.surface = surfaces_.point(origin, direction, hit);
    return met;
}

bool IncomingRadiance::sees_sky(const glm::vec3& origin, const glm::vec3& direction, ShadingScratch& scratch) const {
    ++scratch.sky_rays;
    return !(ground_.distance(origin, direction) < kUnbounded) &&
           !queries_.occluded(origin, direction, queries_.ray_offset(), kUnbounded);
}

std::optional<glm::vec3> IncomingRadiance::along(const glm::vec3& origin, const glm::vec3& direction,
                                                 SampleIndex sample, ShadingScratch& scratch) const {
    const Met met = first_met(origin, direction, scratch);
    if (met.surface)
        return surfaces_.met_radiance(*met.surface, direction, {}, sample, scratch);
    if (met.ground_distance < kUnbounded)
        return ground_light_.met_radiance(origin, direction, met.ground_distance, glm::vec3(0.f), sample, scratch);
    return std::nullopt;
}

glm::vec3 IncomingRadiance::surroundings(const glm::vec3& direction, float roughness) const {
    return lat_long_radiance(environment_.remainder, direction) + wide_lights_in(environment_, direction, roughness);
}

std::optional<glm::vec3> IncomingRadiance::through_lobe(const glm::vec3& origin, const glm::vec3& direction,
                                                        float roughness, SampleIndex sample,
                                                        ShadingScratch& scratch) const {
    glm::vec3 from = origin, along = direction, seen(0.f), share(1.f);
    for (int mirrors = 0;; ++mirrors, sample.pattern += kMirrorPattern) {
        const Met met = first_met(from, along, scratch);
        if (!met.surface) {
            if (met.ground_distance < kUnbounded) {
                const glm::vec3 lights = has_ground() ? glm::vec3(0.f) : wide_lights_in(environment_, along, roughness);
                return seen +
                       share * ground_light_.met_radiance(from, along, met.ground_distance, lights, sample, scratch);
            }
            return mirrors > 0 ? std::optional(seen + share * surroundings(along, roughness)) : std::nullopt;
        }
        const SurfacePoint& at = *met.surface;
        const bool by_rays = mirrors < kMostMirrors && mirrors_by_rays(at, sample);
        MetGloss gloss;
        if (by_rays)
            gloss = {false, std::clamp(roughness, kFinestLights, gloss.least_roughness)};
        seen += share * surfaces_.met_radiance(at, along, gloss, sample, scratch);
        if (!by_rays)
            return seen;
        const LobeSample drawn =
            sample_gloss(glm::normalize(glm::reflect(along, at.normal)), at.roughness,
                         multi_jittered(sample.index, sample.count, sample.pattern ^ kMirrorPattern));
        share *= drawn.weight * at.gloss;
        const float chance = std::min(1.f, kRaysByGloss * luminance(share));
        if (!(glm::dot(at.normal, drawn.direction) > 0) ||
            !(stratified(sample.index, sample.count, sample.pattern ^ (kChoicePattern + 1)) < chance))
            return seen;
        share /= chance;
        roughness = gloss.roughness(at);
        from = at.point;
        along = drawn.direction;
    }
}

} // namespace kokage

#include "reflection/gloss_shading.h"
#include "common/environment/lat_long.h"
#include "reflection/sampling.h"

#include <algorithm>

namespace kokage {
namespace {

/// Make numbers of its own of a pixel's.
constexpr std::uint32_t kLobePattern = 0x9e3779b9u, kChancePattern = 0x7f4a7c15u;
constexpr float kRaysByShare = 4; ///< chance of a ray over the gloss's share of what is seen
constexpr float kLeastChance = 0.25f;
constexpr float kLeastShared = 0.25f; ///< roughness: what smoother patches mirror varies over them

} // namespace

GlossShading::GlossShading(const ShadedScene& scene, const Environment& environment, const SurfaceShading& surfaces,
                           const IncomingRadiance& incoming, const std::optional<RoughnessBounds>& lobes,
                           Progress& progress, WorkReport& report)
    : scene_(scene), environment_(environment), surfaces_(surfaces), incoming_(incoming) {
    if (!lobes)
        return;
    if (!surfaces.has_pixel_shadows()) {
        report.skips.push_back({"reflection map", "patches show the light that was solved, in which gloss is already",
                                "one bake of the surroundings"});
        return;
    }
    remainder_.emplace(environment, std::clamp(lobes->least, kLeastRoughness, 1.f),
                       std::clamp(lobes->most, kLeastRoughness, 1.f), progress, report);
    from_maps_.emplace(scene, environment, surfaces);
    for (const SurfaceLook& look : scene.looks)
        even_.push_back(!look.gloss.is_matt() && !look.smooth_normals && !look.gloss.roughness_texture &&
                        !look.gloss.roughness_gradient && look.gloss.roughness >= kLeastShared);
    if (std::find(even_.begin(), even_.end(), true) != even_.end())
        of_patches_ = ValuesOfSome<LobeLight>(2 * scene.patches->patches.size());
}

std::optional<std::uint32_t> GlossShading::lobe_of_patch(const SurfacePoint& at) const {
    if (of_patches_.places() == 0 || at.relief || !even_[scene_.triangle_look[at.triangle]])
        return std::nullopt;
    return 2 * at.patch + !at.front;
}

glm::vec3 GlossShading::mirrored(const SurfacePoint& at, const glm::vec3& direction) {
    return glm::normalize(glm::reflect(direction, at.normal));
}

glm::vec3 GlossShading::open_light(const SurfacePoint& at, const glm::vec3& direction) const {
    return remainder_->radiance(at.normal, mirrored(at, direction), at.roughness);
}

std::optional<glm::vec3> GlossShading::met(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                                           ShadingScratch& scratch) const {
    if (at.relief && at.relief->hides(direction))
        return surfaces_.solved_radiance(at); // bark opposite
    return incoming_.through_lobe(at.point, direction, at.roughness, sample, scratch);
}

glm::vec3 GlossShading::light_of_ray(const SurfacePoint& at, const glm::vec3& direction, const glm::vec2& numbers,
                                     SampleIndex sample, ShadingScratch& scratch) const {
    const LobeSample drawn = sample_gloss(mirrored(at, direction), at.roughness, numbers);
    if (!(glm::dot(at.normal, drawn.direction) > 0))
        return glm::vec3(0.f);
    return drawn.weight * met(at, drawn.direction, sample, scratch)
                              .value_or(lat_long_radiance(environment_.remainder, drawn.direction));
}

glm::vec3 GlossShading::correction(const SurfacePoint& at, const glm::vec3& direction, const glm::vec2& numbers,
                                   SampleIndex sample, ShadingScratch& scratch) const {
    const LobeSample drawn = sample_gloss(mirrored(at, direction), at.roughness, numbers);
    if (!(glm::dot(at.normal, drawn.direction) > 0))
        return glm::vec3(0.f);
    const std::optional<glm::vec3> found = met(at, drawn.direction, sample, scratch);
    return drawn.weight * (found ? *found - lat_long_radiance(environment_.remainder, drawn.direction)
                                 : wide_lights_in(environment_, drawn.direction, at.roughness));
}

/// Where relief hides the lobe, there is bark opposite.
glm::vec3 GlossShading::light_of_maps(const SurfacePoint& at, const glm::vec3& direction) const {
    const glm::vec3 light = from_maps_->radiance(at, mirrored(at, direction));
    return at.relief ? glm::mix(surfaces_.solved_radiance(at), light, at.relief->openness) : light;
}

/// Few rays are enough where the gloss is faint beside what else is seen (Russian roulette, Arvo and Kirk 1990).
float GlossShading::chance_of_ray(const glm::vec3& open, const glm::vec3& beside) {
    const float by_gloss = luminance(open), all = by_gloss + luminance(beside);
    return all > 0 ? std::clamp(kRaysByShare * by_gloss / all, kLeastChance, 1.f) : 1.f;
}

glm::vec3 GlossShading::radiance(const SurfacePoint& at, const glm::vec3& direction, const glm::vec3& beside,
                                 SampleIndex sample, ShadingScratch& scratch) const {
    if (!remainder_ || !(at.gloss.r > 0 || at.gloss.g > 0 || at.gloss.b > 0))
        return glm::vec3(0.f);
    if (const auto lobe = lobe_of_patch(at))
        if (const LobeLight* light = of_patches_.find(*lobe))
            return at.gloss * light->mean * light->gradient.at(at.point);
    if (has_maps(at))
        return at.gloss * light_of_maps(at, direction);
    const glm::vec3 open = at.gloss * open_light(at, direction);
    const float chance = chance_of_ray(open, beside);
    if (chance < 1 && !(stratified(sample.index, sample.count, sample.pattern ^ kChancePattern) < chance))
        return open;
    const glm::vec2 numbers = multi_jittered(sample.index, sample.count, sample.pattern ^ kLobePattern);
    return open + at.gloss * correction(at, direction, numbers, sample, scratch) / chance;
}

} // namespace kokage

#include "reflection/gloss_shading.h"
#include "common/environment/lat_long.h"
#include "reflection/sampling.h"

#include <algorithm>

namespace kokage {
namespace {

constexpr std::uint32_t kLobePattern = 0x9e3779b9u; ///< makes numbers of its own of a pixel's

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
    // The horizon's correction reads narrower lobes than the surface's own.
    remainder_.emplace(environment, std::clamp(0.4f * lobes->least, kLeastRoughness, 1.f),
                       std::clamp(lobes->most, kLeastRoughness, 1.f), progress, report);
    for (const SurfaceLook& look : scene.looks)
        even_.push_back(!look.gloss.is_matt() && !look.smooth_normals && !look.gloss.roughness_texture &&
                        !look.gloss.roughness_gradient);
    if (std::find(even_.begin(), even_.end(), true) != even_.end())
        of_patches_.assign(2 * scene.patches->patches.size(), glm::vec3(-1.f));
}

std::optional<std::uint32_t> GlossShading::lobe_of_patch(const SurfacePoint& at) const {
    if (of_patches_.empty() || at.relief || !even_[scene_.triangle_look[at.triangle]])
        return std::nullopt;
    return 2 * at.patch + !at.front;
}

LobeLight GlossShading::light(const SurfacePoint& at, const glm::vec3& direction, const glm::vec2& numbers,
                              SampleIndex sample, ShadingScratch& scratch) const {
    const glm::vec3 mirrored = glm::normalize(glm::reflect(direction, at.normal));
    LobeLight light{remainder_->radiance(at.normal, mirrored, at.roughness)};
    const LobeSample drawn = sample_gloss(mirrored, at.roughness, numbers);
    if (!(glm::dot(at.normal, drawn.direction) > 0))
        return light;
    const std::optional<glm::vec3> met = at.relief && at.relief->hides(drawn.direction)
                                             ? surfaces_.solved_radiance(at) // bark opposite
                                             : incoming_.along(at.point, drawn.direction, sample, scratch);
    light.correction = drawn.weight * (met ? *met - lat_long_radiance(environment_.remainder, drawn.direction)
                                           : wide_lights_in(environment_, drawn.direction, at.roughness));
    return light;
}

glm::vec3 GlossShading::radiance(const SurfacePoint& at, const glm::vec3& direction, SampleIndex sample,
                                 ShadingScratch& scratch) const {
    if (!remainder_ || !(at.gloss.r > 0 || at.gloss.g > 0 || at.gloss.b > 0))
        return glm::vec3(0.f);
    if (const auto lobe = lobe_of_patch(at); lobe && of_patches_[*lobe].r >= 0)
        return at.gloss * of_patches_[*lobe];
    const LobeLight lobe_light =
        light(at, direction, multi_jittered(sample.index, sample.count, sample.pattern ^ kLobePattern), sample, scratch);
    return at.gloss * (lobe_light.open + lobe_light.correction);
}

} // namespace kokage

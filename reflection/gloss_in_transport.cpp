#include "reflection/gloss_in_transport.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// Factors of the sum and of the difference of a patch's two radiances, per channel.
struct SideFactors {
    glm::vec3 sum{1.f}, difference{1.f};
};

SideFactors factors(const Optics& with_gloss, const Optics& without) {
    SideFactors result;
    for (std::size_t c = 0; c < 3; ++c) {
        const float tau = without.transmittance[c], all = with_gloss.reflectance[c] + tau;
        if (!(all > 0) || with_gloss.reflectance[c] == without.reflectance[c])
            continue;
        result.sum[c] = (without.reflectance[c] + tau) / all;
        const float apart = with_gloss.reflectance[c] - tau;
        result.difference[c] = std::abs(apart) > 0.02f * all
                                   ? std::clamp((without.reflectance[c] - tau) / apart, -1.f, 1.f)
                                   : result.sum[c];
    }
    return result;
}

} // namespace

std::vector<Optics> optics_with_gloss(const ShadedScene& scene) {
    const PatchScene& patches = *scene.patches;
    std::vector<Optics> optics = patches.optics;
    if (scene.looks.empty())
        return optics;
    std::vector<glm::vec3> mirrored;
    for (const SurfaceLook& look : scene.looks)
        mirrored.push_back(look.gloss.is_matt() ? glm::vec3(0.f)
                                                : mean_gloss_reflectance(look.gloss.normal_reflectance,
                                                                         std::clamp(roughness_bounds(look.gloss).mean,
                                                                                    kLeastRoughness, 1.f)));
    std::vector<glm::dvec3> sums(optics.size(), glm::dvec3(0.));
    std::vector<double> counts(optics.size(), 0.);
    for (const Patch& patch : patches.patches)
        if (patch.triangle_count > 0) {
            sums[patch.optics] += glm::dvec3(mirrored[scene.triangle_look[patch.first_triangle]]);
            ++counts[patch.optics];
        }
    for (std::size_t k = 0; k < optics.size(); ++k)
        if (counts[k] > 0)
            optics[k].reflectance =
                glm::max(optics[k].reflectance, glm::min(optics[k].reflectance + glm::vec3(sums[k] / counts[k]),
                                                         1.f - optics[k].transmittance));
    return optics;
}

void take_gloss_out(const std::vector<Optics>& with_gloss, ShadedScene& scene) {
    const PatchScene& patches = *scene.patches;
    std::vector<SideFactors> of_optics;
    for (std::size_t k = 0; k < with_gloss.size(); ++k)
        of_optics.push_back(factors(with_gloss[k], patches.optics[k]));
    const auto changes = [](const SideFactors& factor) {
        return factor.sum != glm::vec3(1.f) || factor.difference != glm::vec3(1.f);
    };
    if (std::none_of(of_optics.begin(), of_optics.end(), changes))
        return; // all is matt
    scene.gloss_front.assign(patches.patches.size(), glm::vec3(0.f));
    scene.gloss_back = scene.gloss_front;
    for (std::size_t p = 0; p < patches.patches.size(); ++p) {
        const SideFactors& factor = of_optics[patches.patches[p].optics];
        glm::vec3 &front = scene.indirect_front[p], &back = scene.indirect_back[p];
        if (!changes(factor))
            continue;
        const glm::vec3 sum = 0.5f * factor.sum * (front + back), apart = 0.5f * factor.difference * (front - back),
                        matt_front = glm::max(sum + apart, glm::vec3(0.f)),
                        matt_back = glm::max(sum - apart, glm::vec3(0.f));
        scene.gloss_front[p] = glm::max(front - matt_front, glm::vec3(0.f));
        scene.gloss_back[p] = glm::max(back - matt_back, glm::vec3(0.f));
        front = matt_front;
        back = matt_back;
    }
}

} // namespace kokage

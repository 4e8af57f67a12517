#include "reflection/lobe_prior.h"

#include <algorithm>
#include <bit>

namespace kokage {
namespace {

/// How many rays the mean correction of a class counts as, beside a patch's own: a ray's light varies hardly more than
/// patches' corrections do.
constexpr double kRaysOfMean = 2;
/// By powers of two of the rays, and by quarters that are seen.
constexpr std::size_t kPowers = 10, kShares = 4;

} // namespace

std::size_t LobePrior::class_of(const GatheredLobe& lobe) {
    const auto power = std::size_t(std::bit_width(std::uint32_t(std::min(lobe.weight, 1e9f))));
    const auto share = std::size_t(std::clamp(lobe.seen_share, 0.f, 1.f) * (kShares - 0.001f));
    return (kPowers * lobe.look + std::min(power, kPowers - 1)) * kShares + share;
}

LobePrior::LobePrior(std::span<const GatheredLobe> lobes) {
    for (const GatheredLobe& lobe : lobes) {
        const std::size_t of_class = class_of(lobe);
        classes_.resize(std::max(classes_.size(), of_class + 1));
        classes_[of_class].correction += glm::dvec3(lobe.correction);
        classes_[of_class].weight += double(lobe.weight);
    }
    for (const GatheredLobe& lobe : lobes) {
        Class& of_class = classes_[class_of(lobe)];
        const glm::dvec3 light = expected(lobe);
        of_class.light += double(lobe.weight) * light;
        of_class.positive += double(lobe.weight) * glm::max(light, 0.);
    }
}

glm::dvec3 LobePrior::expected(const GatheredLobe& lobe) const {
    const Class& all = classes_[class_of(lobe)];
    const double own = double(lobe.weight);
    return glm::dvec3(lobe.open) / own +
           (glm::dvec3(lobe.correction) + kRaysOfMean * all.correction / all.weight) / (own + kRaysOfMean);
}

glm::vec3 LobePrior::light(const GatheredLobe& lobe) const {
    const Class& all = classes_[class_of(lobe)];
    const glm::dvec3 light = glm::max(expected(lobe), 0.);
    glm::vec3 result(0.f);
    for (glm::length_t c = 0; c < 3; ++c)
        if (all.positive[c] > 0)
            result[c] = float(light[c] * std::max(all.light[c], 0.) / all.positive[c]);
    return result;
}

} // namespace kokage

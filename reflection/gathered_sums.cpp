#include "reflection/gathered_sums.h"

#include <algorithm>

namespace kokage {
namespace {

/// How many rays the mean correction of a look counts as, beside a patch's own: a ray's light varies about four times
/// as much (in standard deviation) as patches' corrections do; of lobes, hardly more than they do.
constexpr double kRaysOfPrior = 16, kLobesOfPrior = 2;
/// Rays of a patch (or corner) after which more are not worth their time. A patch that has so many pixels is large: the
/// eye would miss how its reflections change, so they are traced pixel by pixel.
constexpr float kEnough = 400;
constexpr float kLeastWeight = 1e-6f; ///< of a corner, so that no product is too small for a number

} // namespace

GatheredSums::GatheredSums(std::size_t places, std::size_t looks, std::size_t lobes)
    : of_places_(places), of_lobes_(lobes), moments_of_places_(places), moments_of_lobes_(lobes), of_looks_(2 * looks),
      lobes_of_looks_(2 * looks) {}

void GatheredSums::add(const GatheredSample& sample) {
    for (std::size_t k = 0; k < 3; ++k)
        if (const float weight = sample.places.weights[k]; weight > kLeastWeight)
            of_places_.at(sample.places.places[k]).add(weight, sample.gathered, sample.solved, sample.prior);
    if (sample.is_flat)
        moments_of_places_.at(sample.places.places[0], sample.origin).add(sample.point, luminance(sample.gathered));
    of_looks_[sample.prior].add(1, sample.gathered, sample.solved, sample.prior);
    if (sample.lobe) {
        of_lobes_.at(*sample.lobe).add(1, sample.lobe_correction, sample.lobe_open, sample.prior);
        moments_of_lobes_.at(*sample.lobe, sample.origin)
            .add(sample.point, luminance(sample.lobe_open + sample.lobe_correction));
        lobes_of_looks_[sample.prior].add(1, sample.lobe_correction, sample.lobe_open, sample.prior);
    }
    ++samples_;
}

void GatheredSums::end_pass() {
    for (Sum& sum : of_places_.values())
        sum.has_enough = sum.weight >= kEnough;
    if (passes_++ == 0)
        for (Sum& sum : of_lobes_.values())
            sum.is_large = sum.weight >= kEnough;
}

std::size_t GatheredSums::bytes() const {
    return of_places_.bytes() + of_lobes_.bytes() + moments_of_places_.bytes() + moments_of_lobes_.bytes() +
           (of_looks_.capacity() + lobes_of_looks_.capacity()) * sizeof(LookSum);
}

double GatheredSums::most_bytes(const Counts& counts) {
    const double places = 2 * (counts.patches + counts.corners), lobes = 2 * counts.patches;
    using Sums = ValuesOfSome<Sum>;
    using Moments = ValuesOfSome<PatchMoments>;
    return Sums::most_bytes(places, counts.seen_patches + counts.seen_corners) +
           Sums::most_bytes(lobes, counts.seen_patches) + Moments::most_bytes(places, counts.seen_patches) +
           Moments::most_bytes(lobes, counts.seen_patches);
}

bool GatheredSums::enough(const LightPlaces& places) const {
    for (std::size_t k = 0; k < 3; ++k)
        if (places.weights[k] > kLeastWeight)
            if (const Sum* sum = of_places_.find(places.places[k]); !sum || !sum->has_enough)
                return false;
    return true;
}

glm::dvec3 GatheredSums::ratio(const LookSum& sum) {
    glm::dvec3 result(1.);
    for (std::size_t c = 0; c < 3; ++c)
        if (sum.solved[c] > 0) {
            const double prior = kRaysOfPrior * sum.solved[c] / sum.weight;
            result[c] = (sum.gathered[c] + prior) / (sum.solved[c] + prior);
        }
    return result;
}

/// What was solved as black has nothing to scale: it becomes what was gathered.
glm::vec3 GatheredSums::corrected(const glm::vec3& light, const Sum& sum, const glm::dvec3& ratio_of_look) {
    glm::vec3 result(0.f);
    const double rays = double(sum.weight) + kRaysOfPrior;
    for (std::size_t c = 0; c < 3; ++c) {
        const double mean = double(sum.solved[c]) / double(sum.weight);
        const double gathered = double(sum.gathered[c]) + kRaysOfPrior * mean * ratio_of_look[c];
        result[c] = float(mean > 0 ? double(light[c]) * gathered / (mean * rays)
                                   : double(sum.gathered[c]) / double(sum.weight));
    }
    return result;
}

void GatheredSums::give_light(SurfaceShading& surfaces) const {
    of_places_.for_each([&](std::uint32_t place, const Sum& sum) {
        surfaces.set_light(place, corrected(surfaces.light(place), sum, ratio(of_looks_[sum.prior])));
    });
    moments_of_places_.for_each(
        [&](std::uint32_t place, const PatchMoments& moments) { surfaces.set_gradient(place, moments.gradient()); });
}

void GatheredSums::give_lobes(GlossShading& gloss) const {
    of_lobes_.for_each([&](std::uint32_t lobe, const Sum& sum) {
        if (sum.is_large)
            return;
        const LookSum& all = lobes_of_looks_[sum.prior];
        const glm::dvec3 prior = kLobesOfPrior * all.gathered / all.weight,
                         correction = (glm::dvec3(sum.gathered) + prior) / (double(sum.weight) + kLobesOfPrior);
        gloss.set_light_of_patch(lobe, glm::max(sum.solved / sum.weight + glm::vec3(correction), glm::vec3(0.f)),
                                 moments_of_lobes_.find(lobe)->gradient());
    });
}

} // namespace kokage

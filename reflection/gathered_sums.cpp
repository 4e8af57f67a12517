#include "reflection/gathered_sums.h"
#include "reflection/lobe_prior.h"
#include "reflection/seen_share.h"

#include <algorithm>
#include <vector>

namespace kokage {
namespace {

/// Classes of a look and side, for what is expected of gathered light: tenths that are seen of a patch, and corners.
constexpr std::uint32_t kShares = 11, kCorners = kShares, kClassesOfLook = kShares + 1;
/// Rays of a patch (or corner) after which more are not worth their time. A patch that has so many pixels is large: the
/// eye would miss how its reflections change, so they are traced pixel by pixel.
constexpr float kEnough = 400;
constexpr float kLeastWeight = 1e-6f; ///< of a corner, so that no product is too small for a number

/// Of the pixels that a side of a patch would cover with nothing before it; 0 where it would cover none.
double seen_share(const PatchScene& patches, const Patch& patch, bool front, const CameraFrame& frame, double pixels) {
    const double could_be_seen = pixels_of_patch(patches, patch, front, frame);
    return could_be_seen > 0 ? std::clamp(pixels / could_be_seen, 0., 1.) : 0;
}

} // namespace

GatheredSums::GatheredSums(std::size_t places, std::size_t lobes)
    : of_places_(places), of_lobes_(lobes), moments_of_places_(places), moments_of_lobes_(lobes) {}

void GatheredSums::add(const GatheredSample& sample) {
    for (std::size_t k = 0; k < 3; ++k)
        if (const float weight = sample.places.weights[k]; weight > kLeastWeight)
            of_places_.at(sample.places.places[k]).add(weight, sample.gathered, sample.solved, sample.look);
    if (sample.is_flat)
        moments_of_places_.at(sample.places.places[0], sample.origin).add(sample.point, luminance(sample.gathered));
    if (sample.lobe) {
        Lobe& lobe = of_lobes_.at(*sample.lobe);
        lobe.open += sample.lobe_open;
        lobe.correction += sample.lobe_correction;
        ++lobe.weight;
        lobe.look = sample.look;
        moments_of_lobes_.at(*sample.lobe, sample.origin)
            .add(sample.point, luminance(sample.lobe_open + sample.lobe_correction));
    }
    ++samples_;
}

void GatheredSums::end_pass() {
    ++passes_;
    for (Place& place : of_places_.values())
        if (place.passes == 0 && place.weight >= kEnough)
            place.passes = passes_;
    if (passes_ == 1)
        for (Lobe& lobe : of_lobes_.values())
            lobe.is_large = lobe.weight >= kEnough;
}

std::size_t GatheredSums::bytes() const {
    return of_places_.bytes() + of_lobes_.bytes() + moments_of_places_.bytes() + moments_of_lobes_.bytes();
}

double GatheredSums::most_bytes(const Counts& counts) {
    const double places = 2 * (counts.patches + counts.corners), lobes = 2 * counts.patches;
    using Moments = ValuesOfSome<PatchMoments>;
    return ValuesOfSome<Place>::most_bytes(places, counts.seen_patches + counts.seen_corners) +
           ValuesOfSome<Lobe>::most_bytes(lobes, counts.seen_patches) +
           Moments::most_bytes(places, counts.seen_patches) + Moments::most_bytes(lobes, counts.seen_patches);
}

double GatheredSums::most_bytes_to_give(const Counts& counts) {
    return 2 * (counts.seen_patches + counts.seen_corners) * double(sizeof(PlaceSums) + sizeof(std::uint32_t));
}

bool GatheredSums::enough(const LightPlaces& places) const {
    for (std::size_t k = 0; k < 3; ++k)
        if (places.weights[k] > kLeastWeight)
            if (const Place* place = of_places_.find(places.places[k]); !place || place->passes == 0)
                return false;
    return true;
}

std::uint32_t GatheredSums::class_of(std::uint32_t place, const Place& sums, const PatchScene& patches,
                                     const CameraFrame& frame) const {
    const auto of_side = std::uint32_t(of_places_.places() / 2), number = place % of_side;
    if (number >= patches.patches.size())
        return kClassesOfLook * sums.look + kCorners;
    const double pixels = double(sums.weight) / (sums.passes > 0 ? sums.passes : passes_),
                 share = seen_share(patches, patches.patches[number], place < of_side, frame, pixels);
    return kClassesOfLook * sums.look + std::uint32_t(share * (kShares - 1));
}

void GatheredSums::give_light(SurfaceShading& surfaces, const PatchScene& patches, const CameraFrame& frame) const {
    std::vector<PlaceSums> seen;
    std::vector<std::uint32_t> classes;
    std::uint32_t looks = 0;
    of_places_.for_each([&](std::uint32_t place, const Place& sums) {
        seen.push_back(sums);
        classes.push_back(class_of(place, sums, patches, frame));
        looks = std::max(looks, sums.look + 1);
    });
    const std::vector<GatherPrior> priors =
        fit_gather_priors(seen, classes, std::size_t(looks) * kClassesOfLook, kClassesOfLook);
    auto of_class = classes.begin();
    of_places_.for_each([&](std::uint32_t place, const Place& sums) {
        surfaces.set_light(place, corrected_light(surfaces.light(place), sums, priors[*of_class++]));
    });
    moments_of_places_.for_each(
        [&](std::uint32_t place, const PatchMoments& moments) { surfaces.set_gradient(place, moments.gradient()); });
}

void GatheredSums::give_lobes(GlossShading& gloss, const PatchScene& patches, const CameraFrame& frame) const {
    std::vector<GatheredLobe> seen;
    of_lobes_.for_each([&](std::uint32_t place, const Lobe& lobe) {
        const double pixels = double(lobe.weight) / passes_;
        seen.push_back(lobe);
        seen.back().seen_share = float(seen_share(patches, patches.patches[place / 2], place % 2 == 0, frame, pixels));
    });
    const LobePrior prior(seen);
    auto sums = seen.begin();
    of_lobes_.for_each([&](std::uint32_t place, const Lobe& lobe) {
        if (!lobe.is_large)
            gloss.set_light_of_patch(place, prior.light(*sums), moments_of_lobes_.find(place)->gradient());
        ++sums;
    });
}

} // namespace kokage

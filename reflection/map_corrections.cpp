#include "reflection/map_corrections.h"

namespace kokage {
namespace {

/// A ray's light varies five times as much (in standard deviation) as what maps are off by.
constexpr double kRaysOfPrior = 25;

} // namespace

void MapCorrections::add(const LightPlaces& places, std::uint32_t look, const LobeOfMap& sample) {
    for (std::size_t k = 0; k < 3; ++k)
        if (const float weight = places.weights[k]; weight > 0)
            of_places_.at(places.places[k]).add(weight, sample, look);
    of_looks_[look].add(1, sample, look);
}

/// Where maps are black there is nothing to scale.
template <typename Vector>
glm::dvec3 MapCorrections::ratio(const Sum<Vector>& sum, const glm::dvec3& prior) {
    glm::dvec3 result = prior;
    for (std::size_t c = 0; c < 3; ++c)
        if (sum.map[c] > 0) {
            const double of_prior = kRaysOfPrior * double(sum.map[c]) / double(sum.weight);
            result[c] = (double(sum.ray[c]) + of_prior * prior[c]) / (double(sum.map[c]) + of_prior);
        }
    return result;
}

void MapCorrections::give(GlossShading& gloss) const {
    of_places_.for_each([&](std::uint32_t place, const Sum<glm::vec3>& sum) {
        gloss.scale_maps(place, glm::vec3(ratio(sum, ratio(of_looks_[sum.look], glm::dvec3(1.)))));
    });
}

} // namespace kokage

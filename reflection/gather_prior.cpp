#include "reflection/gather_prior.h"

#include <algorithm>
#include <cmath>

namespace kokage {
namespace {

/// As how many rays a look's mean counts beside a class's own, and no change beside a look's.
constexpr double kRaysOfMean = 16;
/// The same of the spreads, which take more rays to know.
constexpr double kRaysOfSpread = 200;
/// What few rays can't tell: that light varies four times as much from ray to ray (in standard deviation) as
/// corrections do from patch to patch.
constexpr double kUsualRays = 16, kLeastDegrees = 20;
constexpr double kFewestRays = 2, kMostRays = 1000;
/// How far the prior may draw a place from its own rays' mean, in that mean's standard deviations, where these are
/// known: few rays are not spread as many are, a single bright one among them is no sign of a bright place.
constexpr double kFarthest = 1, kRaysToLimit = 16;

/// Of gathered light over expected light.
struct Spread {
    double weight = 0;
    double within = 0, degrees = 0;     ///< squares about places' means, and their degrees of freedom
    double between = 0, of_one_ray = 0; ///< weighted squares of places' means about 1; what one ray's noise adds

    void add(const PlaceSums& sums, const glm::dvec3& ratio) {
        const double w = double(sums.weight), expected = luminance(glm::vec3(ratio) * sums.solved) / sums.weight;
        const double own = double(sums.squared_weights) / w;
        const double squares = double(sums.squares) / (expected * expected);
        const double mean = double(luminance(sums.gathered)) / w / expected;
        if (!(expected > 0) || !std::isfinite(squares + mean * mean))
            return;
        weight += w;
        within += std::max(0., squares - w * mean * mean);
        degrees += w - own;
        between += w * (mean - 1) * (mean - 1);
        of_one_ray += own;
    }
    void add(const Spread& other, double scale) {
        weight += scale * other.weight;
        within += scale * other.within;
        degrees += scale * other.degrees;
        between += scale * other.between;
        of_one_ray += scale * other.of_one_ray;
    }
    bool is_known() const { return degrees > kLeastDegrees && within > 0; }
    double deviation_of_ray() const {
        return is_known() ? std::sqrt(within / degrees) : std::numeric_limits<double>::infinity();
    }
    /// By the method of moments.
    double rays() const {
        if (!is_known())
            return kUsualRays;
        const double of_ray = within / degrees, of_place = std::max(0., between - of_ray * of_one_ray) / weight;
        return std::clamp(of_ray / std::max(of_place, 1e-12), kFewestRays, kMostRays);
    }
};

struct Mean {
    glm::dvec3 gathered{0.}, solved{0.};
    double weight = 0;

    glm::dvec3 ratio(const glm::dvec3& expected) const {
        glm::dvec3 result = expected;
        for (std::size_t c = 0; c < 3; ++c)
            if (solved[c] > 0) {
                const double prior = kRaysOfMean * solved[c] / weight;
                result[c] = (gathered[c] + prior * expected[c]) / (solved[c] + prior);
            }
        return result;
    }
};

} // namespace

void PlaceSums::add(float w, const glm::vec3& of_ray, const glm::vec3& of_solution, std::uint32_t of_look) {
    gathered += w * of_ray;
    solved += w * of_solution;
    weight += w;
    squared_weights += w * w;
    squares += w * luminance(of_ray) * luminance(of_ray);
    look = of_look;
}

std::vector<GatherPrior> fit_gather_priors(std::span<const PlaceSums> members, std::span<const std::uint32_t> class_of,
                                           std::size_t classes, std::size_t classes_of_look) {
    const std::size_t looks = (classes + classes_of_look - 1) / classes_of_look;
    std::vector<Mean> means(classes), means_of_looks(looks);
    for (std::size_t k = 0; k < members.size(); ++k)
        for (Mean* mean : {&means[class_of[k]], &means_of_looks[class_of[k] / classes_of_look]}) {
            mean->gathered += glm::dvec3(members[k].gathered);
            mean->solved += glm::dvec3(members[k].solved);
            mean->weight += double(members[k].weight);
        }
    std::vector<GatherPrior> priors(classes);
    for (std::size_t k = 0; k < classes; ++k)
        priors[k].ratio = means[k].ratio(means_of_looks[k / classes_of_look].ratio(glm::dvec3(1.)));
    std::vector<Spread> spreads(classes), spreads_of_looks(looks);
    for (std::size_t k = 0; k < members.size(); ++k)
        spreads[class_of[k]].add(members[k], priors[class_of[k]].ratio);
    for (std::size_t k = 0; k < classes; ++k)
        spreads_of_looks[k / classes_of_look].add(spreads[k], 1);
    for (std::size_t k = 0; k < classes; ++k) {
        const Spread& of_look = spreads_of_looks[k / classes_of_look];
        if (of_look.weight > 0)
            spreads[k].add(of_look, std::min(1., kRaysOfSpread / of_look.weight));
        priors[k].rays = spreads[k].rays();
        priors[k].deviation = spreads[k].deviation_of_ray();
    }
    return priors;
}

glm::vec3 corrected_light(const glm::vec3& light, const PlaceSums& sums, const GatherPrior& prior) {
    glm::vec3 result(0.f);
    const double own = double(sums.weight), independent = own * own / double(sums.squared_weights);
    const double farthest = independent >= kRaysToLimit ? kFarthest * prior.deviation / std::sqrt(independent)
                                                        : std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < 3; ++c) {
        const double solved = double(sums.solved[c]) / own, gathered = double(sums.gathered[c]) / own,
                     expected = solved * prior.ratio[c];
        const double mean = (own * gathered + prior.rays * expected) / (own + prior.rays), drawn = mean - gathered;
        const double limited =
            std::abs(drawn) > farthest * expected ? gathered + std::copysign(farthest * expected, drawn) : mean;
        result[c] = float(solved > 0 ? double(light[c]) * limited / solved : gathered);
    }
    return result;
}

} // namespace kokage

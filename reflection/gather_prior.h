#pragma once
// What to expect of gathered light before any ray: empirical Bayes over patches that are alike (Efron and Morris 1975).
//
// Rays from a patch tell its light with noise; the solution tells it without, but of the whole patch, not of the part
// that is seen. Patches that are alike (one look and side, seen to a like share) tell by how much the two differ in
// the mean (`ratio`) and how widely (beyond what noise explains). The solution, times the ratio, then counts as so many
// rays as make both errors weigh alike: hundreds for leaves that are seen whole, few for those that peep out. Places
// that are unlike all others of their class (the knob of a lid) are not drawn farther from what their own rays say than
// these may be off (Efron and Morris, "Limiting the Risk of Bayes and Empirical Bayes Estimators", 1971). Private to
// reflection.
#include "common/types.h"

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace kokage {

/// Sums over the rays that told of one place of light (a side of a patch, or of a corner that rays have shares in).
struct PlaceSums {
    glm::vec3 gathered{0.f}, solved{0.f}; ///< radiance times weight
    float weight = 0, squared_weights = 0;
    float squares = 0;      ///< of gathered luminance, times weight
    std::uint32_t look = 0; ///< 2 look + side
    void add(float w, const glm::vec3& of_ray, const glm::vec3& of_solution, std::uint32_t of_look);
};

/// Of one class of places.
struct GatherPrior {
    glm::dvec3 ratio{1.}; ///< gathered over solved
    double rays = 16;     ///< that the solution counts as
    /// Standard deviation of one ray's light, over what is expected of it; infinite: not known.
    double deviation = std::numeric_limits<double>::infinity();
};

/// `members[k]` is in class `class_of[k]` < `classes`; classes in blocks of `classes_of_look` belong together and lend
/// each other what few members can't tell.
std::vector<GatherPrior> fit_gather_priors(std::span<const PlaceSums> members, std::span<const std::uint32_t> class_of,
                                           std::size_t classes, std::size_t classes_of_look);

/// `light` of a place by its rays and the prior, channel by channel. What was solved as black has nothing to scale: it
/// becomes what was gathered.
glm::vec3 corrected_light(const glm::vec3& light, const PlaceSums& sums, const GatherPrior& prior);

} // namespace kokage

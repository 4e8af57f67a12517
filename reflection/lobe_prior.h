#pragma once
// What to expect of the light in a patch's lobe beside its own few rays: the mean of patches of as many rays. Private
// to reflection.
#include "common/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

/// Sums over the rays through one lobe of a side of a patch.
struct GatheredLobe {
    glm::vec3 open{0.f}, correction{0.f}; ///< light of the open surroundings, and what rays found beside that
    float weight = 0;                     ///< rays
    std::uint32_t look = 0;               ///< 2 look + side
    float seen_share = 1;                 ///< of the pixels that it would cover with nothing before it
};

/// Patches of few rays are mostly those that peep out of the shade of others, and what they mirror is darker than what
/// the rest mirrors; blades of grass have few rays, too, and mirror the sky. So only those of one look and side, of
/// about as many rays and seen to a like share lend each other light, and none is won or lost in the mean: what noise
/// makes negative is taken from the rest.
class LobePrior {
  public:
    explicit LobePrior(std::span<const GatheredLobe> lobes);
    /// Radiance in a lobe that was among them; not negative.
    glm::vec3 light(const GatheredLobe& lobe) const;

  private:
    /// Sums weighted by rays.
    struct Class {
        glm::dvec3 correction{0.};
        double weight = 0;
        glm::dvec3 light{0.}, positive{0.}; ///< as expected, and without what is negative
    };
    static std::size_t class_of(const GatheredLobe& lobe);
    glm::dvec3 expected(const GatheredLobe& lobe) const;

    std::vector<Class> classes_;
};

} // namespace kokage

#pragma once
// The crown's outline and the points in it that branches grow towards.
#include "common/types.h"
#include "trees/growth/parameters.h"

#include <vector>

namespace kokage {

/// A dome: a superellipse of revolution about the trunk, flattened below, with billows. Its size follows from the
/// number of leaves.
///
///             ___---___          height_m
///          .-           -.
///         (   widest ->   )      widest_m     radius_m at the widest place
///          '-.         .-'       base_m       crown_bottom x radius_m there
///               | |
class Crown {
  public:
    explicit Crown(const GrowthParameters& parameters);

    float radius_m, height_m, base_m, widest_m;

    /// < 1 inside the crown, 1 on its outline, > 1 outside: how far a point lies from the centre of the widest disc,
    /// relative to the outline in its direction.
    float relative_distance(const glm::vec3& point) const;

    /// Attraction points, `count` of them, denser towards the outline and in clumps; and how far apart they lie.
    struct Attractors {
        std::vector<glm::vec3> points;
        float spacing_m = 0;
    };
    Attractors attractors(int count) const;

  private:
    glm::vec3 normalised(const glm::vec3& point) const;
    float base_towards(const glm::vec3& point) const;
    float lobe_scale(const glm::vec3& direction) const;

    struct Lobe {
        glm::vec3 direction;
        float size;
    };
    std::vector<Lobe> lobes_;
    glm::vec3 base_phases_{0.f};
    float lobe_sharpness_ = 1, lobe_depth_ = 0, roundness_ = 2, lower_depth_m_ = 1, shell_ = 0, clumping_ = 0;
    std::uint64_t seed_;
};

} // namespace kokage

#pragma once
// The crown's outline and the points in it that branches grow towards.
#include "common/services/random.h"
#include "common/types.h"
#include "trees/growth/parameters.h"

#include <vector>

namespace kokage {

/// A main limb's course, from the trunk to its end.
struct Limb {
    std::vector<glm::vec3> course; ///< at least 2 points
    float length_m = 0;
};

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
    /// `parameters` must live as long as the crown.
    explicit Crown(const GrowthParameters& parameters);

    float radius_m, height_m, base_m, widest_m;

    /// < 1 inside the crown, 1 on its outline, > 1 outside: how far a point lies from the centre of the widest disc,
    /// relative to the outline in its direction.
    float relative_distance(const glm::vec3& point) const;

    /// How far apart `count` attraction points lie where the crown is full.
    float spacing_m(int count) const;
    /// Attraction points, `count` of them: denser towards the outline, in clumps, and in layers along the limbs.
    std::vector<glm::vec3> attractors(int count, const std::vector<Limb>& limbs) const;

  private:
    glm::vec3 normalised(const glm::vec3& point) const;
    float base_towards(const glm::vec3& point) const;
    float lobe_scale(const glm::vec3& direction) const;
    float density(const glm::vec3& point) const;
    glm::vec3 lowest_corner() const;
    void draw_points(std::vector<glm::vec3>& points, std::size_t until, Random& random) const;
    void draw_in_layers(std::vector<glm::vec3>& points, std::size_t until, const std::vector<Limb>& limbs,
                        Random& random) const;
    void draw_in_clumps(std::vector<glm::vec3>& points, std::size_t until, Random& random) const;

    struct Lobe {
        glm::vec3 direction;
        float size;
    };
    std::vector<Lobe> lobes_;
    glm::vec3 base_phases_{0.f};
    float lobe_sharpness_ = 1, lower_depth_m_ = 1;
    const GrowthParameters& p_;
};

} // namespace kokage

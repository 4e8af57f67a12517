#pragma once
// Wood that pieces of bark may hang on, while a skeleton grows out of them. Private to trees.
#include "trees/axis_samples.h"

#include <limits>

namespace kokage {

/// Where a piece meets wood.
struct WoodHold {
    AxisPlace axis;
    float depth = std::numeric_limits<float>::infinity(); ///< distance from the axis less its radius: negative inside
    bool touches = false;
};

class StandingWood {
  public:
    /// Takes in the branches from `first_branch` on; `skeleton` must outlive this.
    void add(const Skeleton& skeleton, std::size_t first_branch);
    /// What the end of a branch at `place` hangs on; `reach`: how far from the surface counts as touching. Most tools
    /// let branches begin exactly on the axis that bears them: then that axis it is, or, where another branch begins at
    /// the same place, what bears that one. Else it is the nearest axis; the part of a branch within its parent is then
    /// no place to hang on: the parent is.
    WoodHold nearest(const glm::vec3& place, float reach) const;

  private:
    struct Wood {
        std::vector<AxisSamples::Sample> samples; ///< along each branch in turn
        GrowingPointTree tree;
        void add(const AxisSamples::Sample& sample) {
            samples.push_back(sample);
            tree.add(sample.position);
        }
        AxisPlace nearest(const glm::vec3& place) const {
            const NearestPoint found = tree.nearest(place);
            return found.found() ? nearest_around(samples, found.index, place) : AxisPlace{};
        }
    };
    AxisPlace bearer_of(AxisPlace axis, const glm::vec3& place) const;

    const Skeleton* skeleton_ = nullptr;
    Wood all_, outer_; ///< outer: without what lies within parents
};

} // namespace kokage

#pragma once
// Wood that pieces of bark may hang on, while a skeleton grows out of them. Private to trees.
#include "trees/axis_samples.h"

#include <array>
#include <limits>
#include <map>

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

    /// Most tools let branches begin on the axis that bears them: what has its axis at `place`, measured by its
    /// radius; where another branch begins at the same place, what bears that one. `touches` is false if there is none.
    WoodHold on_axis(const glm::vec3& place) const;

    /// on_axis(), else the nearest axis; the part of a branch within its parent is then no place to hang on: the parent
    /// is. `reach`: how far from the surface counts as touching.
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
    /// Pieces of axes of about one thickness and length. A piece may pass through a place whose nearest sample is
    /// another branch's, so all pieces near it are looked at.
    struct Pieces {
        std::vector<std::array<AxisSamples::Sample, 2>> ends;
        GrowingPointTree middles;
        void add(const AxisSamples::Sample& a, const AxisSamples::Sample& b) {
            ends.push_back({a, b});
            middles.add(0.5f * (a.position + b.position));
        }
    };
    void add_piece(const AxisSamples::Sample& a, const AxisSamples::Sample& b);
    AxisPlace bearer_of(AxisPlace axis, const glm::vec3& place) const;

    const Skeleton* skeleton_ = nullptr;
    std::map<std::array<int, 2>, Pieces> by_size_; ///< by the binary logarithms of the larger radius and of the length
    Wood outer_;                                   ///< without what lies within parents
};

} // namespace kokage

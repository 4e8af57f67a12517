#pragma once
// Which branch's axis is nearest. Private to trees.
#include "common/geometry/point_tree.h"
#include "trees/tree.h"

#include <vector>

namespace kokage {

/// Points along a skeleton's axes, dense enough that the nearest one tells the branch.
struct AxisSamples {
    struct Sample {
        glm::vec3 position;
        float radius_m;
        std::uint32_t branch;
    };
    std::vector<Sample> samples; ///< along each branch in turn
};

/// `first_branch`: samples of branches before it are left out.
AxisSamples sample_axes(const Skeleton& skeleton, std::size_t first_branch = 0);

/// A place on an axis.
struct AxisPlace {
    glm::vec3 position{0.f};
    float radius_m = 0; ///< of the wood there
    float distance = 0; ///< from the place that was asked about to the axis
    std::uint32_t branch = 0;
    bool found = false;
};

/// Of the straight piece of axis between two samples of one branch, what is nearest to a place.
AxisPlace nearest_on_piece(const AxisSamples::Sample& a, const AxisSamples::Sample& b, const glm::vec3& place);

/// Of the sample at `index` and the two pieces of axis that it joins, what is nearest to a place.
AxisPlace nearest_around(const std::vector<AxisSamples::Sample>& samples, std::size_t index, const glm::vec3& place);

/// Searches all axes of a skeleton.
class NearestAxis {
  public:
    explicit NearestAxis(const Skeleton& skeleton);
    AxisPlace at(const glm::vec3& place) const;

  private:
    AxisSamples axes_;
    PointTree tree_;
};

} // namespace kokage

#pragma once
// Draws points on patches: uniform over the solid area of all their triangles.
#include "common/scene/patch_scene.h"
#include "common/trace/path_numbers.h"

#include <vector>

namespace kokage {

struct PatchPoint {
    glm::vec3 position, normal; ///< the front's unit normal
};

/// The scene must outlive it. Thread-safe.
class PatchPoints {
  public:
    explicit PatchPoints(const PatchScene& scene);
    /// A point of a patch; takes one pair of the path's numbers (and independent ones where the pair fell into a hole).
    /// False if the patch has no solid area.
    bool sample(std::uint32_t patch, PathNumbers& numbers, PatchPoint& point) const;
    const std::vector<double>& areas() const { return areas_; } ///< solid area of every patch, m^2
    std::size_t bytes() const { return cumulative_.size() * sizeof(float) + areas_.size() * sizeof(double); }

  private:
    const PatchScene& scene_;
    std::vector<float> cumulative_; ///< per triangle: share of its patch's area up to and with it
    std::vector<double> areas_;
};

} // namespace kokage

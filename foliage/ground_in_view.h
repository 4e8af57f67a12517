#pragma once
// Which cells of the ground each side of a patch sees, by the lines (and rays) that end there.
#include "foliage/bundles/bundle_tracing.h"
#include "foliage/ground_cells.h"

#include <span>

namespace kokage {

class GroundInView {
  public:
    /// No ground in view.
    GroundInView() = default;
    /// `down`: the share of every side's hemisphere that is ground. Lines are taken to leave a patch at its middle.
    GroundInView(const PatchScene& scene, const GroundCells& ground, const bundles::Facets& facets,
                 const bundles::BundleTransport& transport, std::span<const float> down);

    /// Mean radiance of the ground that a side sees, weighted by cosine and open share; 0 where it sees none.
    /// `radiance`: of the cells.
    glm::vec3 mean(bundles::Side side, std::span<const glm::vec3> radiance) const;
    std::size_t bytes() const {
        return begin_.size() * sizeof(begin_[0]) + cells_.size() * (sizeof(cells_[0]) + sizeof(shares_[0]));
    }

  private:
    /// Row of a side: entries [begin_[side], begin_[side + 1]); shares add up to 1.
    std::vector<std::uint32_t> begin_;
    std::vector<std::uint16_t> cells_;
    std::vector<float> shares_;
};

} // namespace kokage

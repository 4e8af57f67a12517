#pragma once
// Which of many directions lie near another: bands of height, ordered by azimuth within.
#include "common/types.h"

#include <cstdint>
#include <span>
#include <vector>

namespace kokage {

class DirectionBands {
  public:
    explicit DirectionBands(std::span<const glm::dvec3> directions);
    /// Appends the indices of all directions within `angle` radians of `axis` (unit), and some beyond, in an order that
    /// depends on the arguments alone.
    void near(const glm::dvec3& axis, double angle, std::vector<std::uint32_t>& indices) const;

  private:
    struct Entry {
        double azimuth;
        std::uint32_t index;
    };
    std::vector<std::vector<Entry>> bands_; ///< equal steps of the polar angle, from +Y
};

} // namespace kokage
